"""The way of somebody who has never seen the app: from the home screen to a report, by keys."""

from __future__ import annotations

import re
import shlex
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from support.key_operator import act_until_done
from support.terminal import Terminal

from armodal.protocols.plan import PLANS_DIRECTORY

__all__ = ["WALKED_POINTS", "Figures", "home_in", "small_plan", "walk_to_the_report"]

WALKED_POINTS = ("1", "4", "8", "11", "15", "18")  # on every moving link
MEASURING_S = 600.0  # of real time: the laboratory's clock is not hurried
ANALYSIS_S = 300.0
SCREEN_S = 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """What the walk took: keys pressed, and seconds of real time."""

    keys_to_first_accepted: int
    seconds_to_first_accepted: float
    seconds_to_done: float  # from the last verdict: journal closed, session file written
    keys_to_finding: int  # from DONE on
    seconds_to_finding: float  # from the last verdict to the verdict of Gap
    seconds_to_report: float


class CountingTerminal(Terminal):
    """A terminal that counts its keys."""

    pressed = 0

    def keys(self, *keys: str) -> None:
        """Press keys; each is counted."""
        self.pressed += len(keys)
        super().keys(*keys)


def home_in(folder: Path) -> CountingTerminal:
    """Return a terminal of 80 x 24 in which `armodal` alone was started in a folder."""
    start = f"cd {shlex.quote(str(folder))} && exec {shlex.quote(sys.executable)} -m"
    return CountingTerminal(["sh", "-c", f"{start} armodal.tui.cli"], columns=80, rows=24)


def small_plan(path: Path, *, postures: int, hits: int) -> Path:
    """Write the shipped plan with its first postures only, six points and few hits each."""
    text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
    head, *every = text.split("[[postures]]")
    points = ", ".join(f'"{name}"' for name in WALKED_POINTS)
    kept = [re.sub(r"points = \[[^\]]*\]", f"points = [{points}]", p) for p in every[:postures]]
    head = head.replace("hits_per_point = 3", f"hits_per_point = {hits}")
    path.write_text("[[postures]]".join([head, *kept]), encoding="utf-8")
    return path


def walk_to_the_report(
    terminal: CountingTerminal, plan: str, seen: Callable[[str], None] = lambda screen: None
) -> Figures:
    """Walk from home through a session in the simulated laboratory to its report, and home again.

    Parameters
    ----------
    plan
        What is typed as the plan; empty: what stands there.
    seen
        Called with every screen while the session is measured.
    """
    terminal.until("try it: hit a simulated arm yourself", SCREEN_S)
    began_s = time.monotonic()
    terminal.keys("s")
    terminal.until("A shipped arm, or your own", SCREEN_S)
    terminal.keys("Enter")
    terminal.until("A shipped plan, or your own", SCREEN_S)
    if plan:
        terminal.keys(*plan)
    terminal.keys("Enter", "Enter", "Enter")
    first: list[float] = []
    verdict_s = began_s
    record = ""

    def look(screen: str) -> None:
        nonlocal verdict_s, record
        seen(screen)
        found = re.search(r"record (\d+) is in the journal", screen)
        if found and found.group(1) != record:
            record, verdict_s = found.group(1), time.monotonic()
            if not first:
                first.extend((terminal.pressed, verdict_s - began_s))

    act_until_done(terminal, MEASURING_S, look)
    done_s = time.monotonic()
    pressed = terminal.pressed
    terminal.keys("Enter")
    terminal.until(r"\d modes automatic", SCREEN_S)
    terminal.keys("7")
    terminal.until("enter: identify", SCREEN_S)
    terminal.keys("Enter")
    terminal.until("Joint stiffness k in N m/rad", ANALYSIS_S)
    terminal.keys("8")
    terminal.until("enter: find where", SCREEN_S)
    terminal.keys("Enter")
    terminal.until("NAMED|AMBIGUOUS|NOTHING DETECTABLE|OUTSIDE THE LIBRARY", ANALYSIS_S)
    found_s, keys_to_finding = time.monotonic(), terminal.pressed - pressed
    terminal.keys("w")
    terminal.until(r"report session\.html, beside", ANALYSIS_S)
    report_s = time.monotonic()
    terminal.keys("q")
    terminal.until("new session", SCREEN_S)
    terminal.keys("q")
    terminal.until("ended 0", SCREEN_S)
    return Figures(
        keys_to_first_accepted=int(first[0]),
        seconds_to_first_accepted=first[1],
        seconds_to_done=done_s - verdict_s,
        keys_to_finding=keys_to_finding,
        seconds_to_finding=found_s - verdict_s,
        seconds_to_report=report_s - verdict_s,
    )
