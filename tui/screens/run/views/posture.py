"""Posture: where each joint is, where it must be, and whether the arm may be approached."""

from __future__ import annotations

import math

import numpy as np
from rich.text import Text

from armodal.protocols.plan_records import PlannedPosture
from armodal.tui.drawing import short_names
from armodal.tui.screens.run.big_text import big_lines
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.views.hit import last_hit_text
from armodal.tui.screens.run.views.parts import BAD, DIM, GOOD, WARN, big
from armodal.tui.screens.run.words import conditions

__all__ = ["joints_text", "posture_word", "word_text"]

LABEL, MARK = 15, 12  # most columns of a name, columns of what stands behind


def posture_word(state: RunState) -> tuple[str, str, str]:
    """Return the large word, its style, and the sentence that goes with it."""
    prompt = state.prompt
    if prompt is None or prompt.posture is None:
        return "WAIT", WARN, "The session is being opened."
    name, also = prompt.posture.name, conditions(prompt.posture)
    if state.awaits_word:
        return "MOVE ARM", WARN, _word_wanted(state, name, also)
    by = (
        " as you said"
        if state.told_rad is not None
        else ""
        if prompt.posture.brakes
        else " by its drives"
    )
    if not state.posture_known:
        return (
            "UNKNOWN",
            BAD,
            "No joint angles arrive. Stay away from the arm; check the controller's CAN cable.",
        )
    if state.held is False:
        return "NOT HELD", BAD, "The drives do not hold the arm. Stay away; let it come to rest."
    if prompt.kind.value != "posture":
        return (
            "APPROACH?",
            GOOD,
            f"At its posture, held{by}.{also} Look: is it safe to go near? Enter: yes, it is.",
        )
    return _on_the_way(state, prompt.posture)


def _on_the_way(state: RunState, posture: PlannedPosture) -> tuple[str, str, str]:
    name, also = posture.name, conditions(posture)
    reading = state.joints
    known = reading.joints_rad if reading is not None else None
    off_rad = np.inf if known is None else float(np.abs(known - posture.joints_rad).max())
    if off_rad <= posture.tolerance_rad:
        still = f"At {name}.{conditions(posture)} It goes on by itself when the arm is still."
        return "KEEP STILL", WARN, still
    hand = " h: the simulated hand moves it." if state.simulated else ""
    bring = f"Bring the arm to posture {name}, from outside its reach.{also}"
    return "MOVE ARM", WARN, bring + hand


def _word_wanted(state: RunState, name: str, also: str) -> str:
    hand = " h: the simulated hand moves it." if state.simulated else ""
    told_deg = math.degrees(state.told_rad or 0.0)
    return (
        f"Bring the arm to posture {name}, from outside its reach.{also}{hand} No device reads its "
        f"joints. Enter: it stands as wanted, by your reading to {told_deg:g}°, and is held. e: "
        "type what you read."
    )


def word_text(state: RunState, width: int, height: int) -> Text:
    """Return the large word with its sentence."""
    word, style, sentence = posture_word(state)
    between = "\n" if height > 1 else "  "
    text = Text.assemble(big(word, style, width=width, height=height), between, sentence)
    prompt = state.prompt
    if state.last_hit is not None and prompt is not None and prompt.kind.value == "posture":
        # The hit that finished a posture is answered here.
        text.append(" ").append_text(last_hit_text(state))
    return text


def joints_text(state: RunState, width: int, height: int) -> Text:
    """Return every joint, now and wanted, as large as the room allows."""
    prompt = state.prompt
    if prompt is None or prompt.posture is None:
        return Text("")
    target = np.degrees(prompt.posture.joints_rad)
    tolerance = float(np.degrees(prompt.posture.tolerance_rad))
    reading = state.joints
    now = None if reading is None or reading.joints_rad is None else np.degrees(reading.joints_rad)
    digits = 1 if tolerance >= 0.2 else 2
    n = len(target)
    rows = next((r for r in (6, 5, 4, 3) if n * r <= height - 1), 1)
    text = Text(no_wrap=True)
    names = short_names([joint.name for joint in state.arm.joints], LABEL - 2)
    label = max(len(name) for name in ("joint", *names)) + 2
    column = max((width - label - MARK) // 2, 8)
    head = f"{'joint':<{label}}{'now':<{column}}{'wanted':<{column}}within {tolerance:g}°"
    text.append(head[:width] + "\n", style=DIM)
    for i, name in enumerate(names):
        there = "?" if now is None else f"{round(now[i], digits) + 0.0:+.{digits}f}"
        wanted = f"{target[i]:+.{digits}f}"
        mark, style = _mark(None if now is None else float(now[i] - target[i]), tolerance, digits)
        _row(text, name.ljust(label), there, wanted, mark, style, column, rows)
    return text


def _mark(off: float | None, tolerance: float, digits: int) -> tuple[str, str]:
    if off is None:
        return "? unknown", BAD
    if abs(off) <= tolerance:
        return "✓", GOOD
    return f"{'↓' if off > 0 else '↑'} by {abs(off):.{digits}f}°", WARN


def _row(
    text: Text, name: str, there: str, wanted: str, mark: str, style: str, column: int, rows: int
) -> None:
    lines = 5 if rows > 5 else min(rows, 3)
    left = big_lines(there, width=column - 2, height=lines)
    right = big_lines(wanted, width=column - 2, height=lines)
    middle = (max(len(left), len(right)) - 1) // 2
    for row in range(max(len(left), len(right))):
        text.append(name if row == middle else " " * len(name), style="bold")
        text.append(_cell(left, row, middle, column), style=style)
        text.append(_cell(right, row, middle, column))
        text.append((mark if row == middle else "") + "\n", style=style)
    text.append("\n" * max(rows - max(len(left), len(right)), 0))


def _cell(lines: list[str], row: int, middle: int, column: int) -> str:
    shift = middle if len(lines) == 1 else 0
    inside = 0 <= row - shift < len(lines)
    return f"{lines[row - shift] if inside else '':<{column}}"
