"""Progress: postures by points with the quality of each, what is missing, the time left."""

from __future__ import annotations

from rich.text import Text

from armodal.tui.screens.run.overview import (
    PointQuality,
    hits_left,
    missing,
    point_qualities,
    seconds_left,
)
from armodal.tui.screens.run.state import Phase, RunState
from armodal.tui.screens.run.views.hit import last_hit_text
from armodal.tui.screens.run.views.parts import BAD, DIM, GOOD, WARN, big, time_words
from armodal.tui.screens.run.words import error_advice

__all__ = ["cell_width", "cursor_line", "grid_text", "left_line", "outcome_text", "summary_text"]

_STYLES = {"●": GOOD, "◐": WARN, "○": "", "-": DIM, "!": WARN}


def cell_width(state: RunState) -> int:
    """Return the columns a cell takes: the longest count, and an edge on either side."""
    longest = max((len(_count(q)) for q in point_qualities(state)), default=4)
    return max(longest, 4) + 2


def grid_text(state: RunState, width: int, cursor: int) -> Text:
    """Return the grid; the cell under the cursor is reversed, the point in hand in brackets."""
    text = Text(no_wrap=True)
    qualities = point_qualities(state)
    cell = cell_width(state)
    for posture in state.plan.postures:
        own = [(i, q) for i, q in enumerate(qualities) if q.posture == posture.name]
        done = sum(q.accepted >= q.wanted for _, q in own)
        text.append(posture.name, style="bold")
        kind = ", for validation" if posture.validation else ""
        text.append(f"  {done} of {len(own)} points{kind}\n", style=DIM)
        per_row = max(width // cell, 1)
        for start in range(0, len(own), per_row):
            row = own[start : start + per_row]
            for i, quality in row:
                _cell(text, quality.point, quality, cell, reverse=i == cursor)
            text.append("\n")
            for i, quality in row:
                _cell(text, _count(quality), quality, cell, reverse=i == cursor)
            text.append("\n")
    text.append("● done  ◐ begun  ○ to do  - skipped  ! done, with many rejects", style=DIM)
    return text


def cursor_line(state: RunState, width: int, cursor: int) -> int:
    """Return the line of the grid on which the cursor's cell begins."""
    per_row = max(width // cell_width(state), 1)
    line = 0
    for posture in state.plan.postures:
        n = len(posture.points)
        if cursor < n:
            return line + 1 + 2 * (max(cursor, 0) // per_row)
        line += 1 + 2 * (-(-n // per_row))
        cursor -= n
    return 0


def _count(quality: PointQuality) -> str:
    return f"{quality.mark}{quality.accepted}/{quality.wanted}"


def _cell(text: Text, words: str, quality: PointQuality, cell: int, *, reverse: bool) -> None:
    style = _STYLES[quality.mark] + (" reverse" if reverse else "")
    edges = ("[", "]") if quality.here else (" ", " ")
    text.append(edges[0] + words[: cell - 2].center(cell - 2) + edges[1], style=style.strip())


def left_line(state: RunState) -> Text:
    """Return what is left in one line, and how to go to a point."""
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(f"{hits_left(state)} hits left, {time_words(seconds_left(state))}", style="bold")
    if state.phase is Phase.SESSION:
        text.append("  arrows, Enter: go there  g: back", style=DIM)
    return text


def summary_text(state: RunState) -> Text:
    """Return what is missing, and what else was said."""
    text = Text()
    lacking = missing(state)
    for posture, points in lacking:
        text.append(f"missing in {posture}: ", style=DIM)
        planned = next(p for p in state.plan.postures if p.name == posture)
        every = len(points) == len(planned.points)
        text.append((f"all {len(points)} points" if every else ", ".join(points)) + "\n")
    if not lacking:
        text.append("nothing is missing\n", style=GOOD)
    for note in state.notes[-3:]:
        text.append(f"· {note}\n", style=DIM)
    return text


def outcome_text(state: RunState, width: int) -> Text:
    """Return how the session ended or why it cannot go on, and the way back."""
    if state.phase is Phase.FAILED and state.failed is not None:
        words, advice = error_advice(state.failed.kind, state.failed.message)
        text = big("STOPPED", BAD, width=width, height=3)
        text.append(f"\n{words}. {advice}\n", style="bold")
        text.append(f"{state.failed.message}\n", style="")
        if state.failed.journal:
            text.append(f"Every accepted hit is safe in {state.failed.journal}.\n", style=GOOD)
        text.append("r: try again and go on at the same point   q: leave", style="bold")
        return text
    finished = state.finished
    if state.phase is not Phase.ENDED or finished is None:
        done = state.prompt is not None and state.prompt.posture is None
        return last_hit_text(state) if done else Text("")
    if finished.complete:
        word, style, again = "DONE", GOOD, ""
    elif hits_left(state):
        word, style, again = "PAUSED", WARN, "r: go on at the same point   "
    else:
        word, style, again = "SKIPPED", WARN, "r: measure what was skipped   "
    text = big(word, style, width=width, height=3)
    text.append(
        f"\n{finished.accepted} hits accepted, {finished.rejected} not: {finished.reason}\n"
    )
    if state.last_hit is not None:
        text.append_text(last_hit_text(state)).append("\n")
    text.append(f"journal {finished.journal}\n")
    if state.file_problem is not None:
        text.append(f"session file not written: {state.file_problem}\n", style=WARN)
    elif state.session_file is None:
        text.append("the session file is being written ...\n", style=DIM)
    else:
        text.append(f"session {state.session_file}\n")
        again = f"Enter: look at the modes   {again}"
    text.append(f"{again}q: leave", style="bold")
    return text
