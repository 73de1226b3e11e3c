"""Pieces that several screens share: state, safety, losses, time."""

from __future__ import annotations

from rich.text import Text

from armodal.tui.screens.run.big_text import big_lines
from armodal.tui.screens.run.overview import hits_left, point_qualities, seconds_left
from armodal.tui.screens.run.state import Phase, RunState
from armodal.tui.screens.run.words import safety_line

__all__ = ["BAD", "DIM", "GOOD", "WARN", "big", "losses_text", "safety_text", "time_words", "title"]

GOOD, BAD, WARN = "bold bright_green", "bold bright_red", "bold bright_yellow"
DIM = "dim"


def big(text: str, style: str, *, width: int, height: int = 5) -> Text:
    """Return a word in the largest letters that fit."""
    lines = "\n".join(big_lines(text, width=width, height=height))
    return Text().append(lines, style=style)


def time_words(seconds: float | None) -> str:
    """Return a duration in words; unknown is said.

    >>> time_words(3700.0), time_words(95.0), time_words(None)
    ('1 h 2 min', '2 min', 'time left unknown yet')
    """
    if seconds is None:
        return "time left unknown yet"
    if seconds < 45.0:
        return "less than a minute"
    minutes = round(seconds / 60.0)
    return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes} min"


def title(state: RunState, width: int) -> Text:
    """Return the line at the top: plan, place, and how far the session is."""
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(" armodal ", style="bold reverse")
    text.append(f" {state.plan.name}")
    if state.simulated:
        text.append("  SIMULATED", style=WARN)
    here = state.here
    if state.phase is Phase.SESSION and here is not None:
        text.append(f"  {here[0]}, point {here[1]}", style="bold")
    qualities = point_qualities(state)
    done = sum(q.accepted >= q.wanted for q in qualities)
    right = f"{done}/{len(qualities)} points  {hits_left(state)} hits left "
    if width > 110:
        right = f"{time_words(seconds_left(state))}  " + right
    gap = width - text.cell_len - len(right)
    if gap >= 2:
        text.append(" " * gap + right)
    return text


def safety_text(state: RunState) -> Text:
    """Return whether the arm may be approached, in a form that needs no colour."""
    safe, words = safety_line(state)
    mark, style = ("✓", GOOD) if safe else ("✗", BAD)
    if state.phase is not Phase.SESSION and not safe and state.board is None:
        return Text().append("no data from the robot controller yet", style=DIM)
    if safe and state.safe:
        words += ", approach confirmed"
    return Text().append(f"{mark} {words}", style=style)


def losses_text(state: RunState, room: int) -> Text:
    """Return the loss counters, in so many columns: only that nothing was lost gives way."""
    if not state.losses:
        nothing = Text("lost: nothing", style="bright_green")
        return nothing if nothing.cell_len <= room else Text("")
    words = ", ".join(f"{kind} {count}" for kind, count in sorted(state.losses))
    if state.simulated and state.time_scale > 1.0:
        words += f" (by the simulator, {state.time_scale:g} times as fast as real time)"
    return Text(f"! lost: {words}", style=WARN, no_wrap=True, overflow="ellipsis")
