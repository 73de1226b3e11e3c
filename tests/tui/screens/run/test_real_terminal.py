"""The app in a real terminal, against the simulated laboratory, driven by keys only."""

from __future__ import annotations

import os
import re
import signal
from contextlib import closing
from pathlib import Path

import pytest
from support.key_operator import act_until_done
from support.run_by_hand import first_accepted_hit
from support.terminal import Terminal, armodal

from armodal.hil_sim.lab import start_laboratory
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import PLANS_DIRECTORY, load_plan
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.journal import load_journal
from armodal.tui.operators import ScriptedOperator

pytestmark = pytest.mark.usefixtures("real_time")
TIME_SCALE = "4"


@pytest.fixture
def small_plan(tmp_path: Path) -> Path:
    text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
    head, first, *_ = text.split("[[postures]]")
    first = re.sub(r"points = \[[^\]]*\]", 'points = ["1", "3"]', first)
    head = head.replace("hits_per_point = 3", "hits_per_point = 2")
    path = tmp_path / "small.toml"
    path.write_text(f"{head}[[postures]]{first}")
    return path


@pytest.mark.long
def test_a_session_is_done_by_doing_what_the_screen_says(small_plan, tmp_path):
    journal = tmp_path / "s.journal"
    command = armodal("run", str(small_plan), "--sim", "--session", str(journal))
    accepted_shown: set[int] = set()

    def look(screen: str) -> None:
        for number in re.findall(r"✓ record (\d+) is in the journal", screen):
            accepted_shown.add(int(number))
            # What the screen calls accepted is on the disk already.
            numbers = {h.number for h in load_journal(journal).hits if h.verdict.accepted}
            assert int(number) in numbers

    with Terminal([*command, "--time-scale", TIME_SCALE]) as terminal:
        screen = act_until_done(terminal, 120.0, look)
        assert "lost:" in screen
        terminal.keys("q")
        terminal.until("ended 0", 20.0)
    session = read_session(journal.with_suffix(".h5"))
    assert session.complete
    accepted = {hit.number for hit in session.accepted()}
    assert len(accepted) == 2 * 2
    assert accepted_shown <= accepted


@pytest.mark.long
def test_killing_the_app_loses_no_hit_and_coming_back_goes_on(small_plan, tmp_path):
    journal = tmp_path / "k.journal"
    arm = load_arm("rv4frl")
    plan = load_plan(small_plan, arm)
    scale = float(TIME_SCALE)
    with (
        start_laboratory("rv4frl", seed=2, time_scale=scale) as laboratory,
        closing(ScriptedOperator(laboratory.operator, arm, plan, time_scale=scale)) as hand,
    ):
        ports = ["--board", laboratory.board, "--can", laboratory.can, "--time-scale", TIME_SCALE]
        command = armodal("run", "--session", str(journal), *ports)
        with Terminal([*command, str(small_plan)]) as terminal:
            first_accepted_hit(terminal, hand, plan)
            accepted = len(load_journal(journal).accepted())
            os.kill(terminal.program_pid(), signal.SIGKILL)
            terminal.until("ended 137", 20.0)
        with Terminal(command) as terminal:
            # The acquisition that was left alone closes its journal first.
            terminal.until("Are these sensors", 60.0)
            terminal.keys("Enter")
            safe = f"{accepted} accepted hits are safe"
            terminal.until("go on at the same point", 20.0, safe)
            terminal.keys("Enter")
            terminal.until("Enter: yes, it is", 60.0, "test 1, point 1")
            terminal.keys("q")
            terminal.until("ended 0", 30.0)
    assert len(load_journal(journal).accepted()) == accepted == 1
