"""`armodal gap --simulator mujoco --motion`: a logged trajectory in the user's own simulator."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from armodal.analyzer.export.by_mujoco import load_mujoco
from armodal.analyzer.simulator.motion import FOLLOWS, PointComparison, compare_with_motion
from armodal.analyzer.simulator.motion_page import motion_page
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.motion_log import MotionLog
from armodal.protocols.foreign.read_motion import read_motion_log
from armodal.protocols.text_file import replace_text
from armodal.tui.console import out, print_json, print_note, say, say_next

__all__ = ["show_motion"]

_LITTLE = 0.3  # of what a sensor reads: hardly the drives' motion
_TOLD = 8  # columns that are not used


def show_motion(
    plain: Arm,
    corrected: Arm,
    model: Path,
    motion: Path,
    topics: Sequence[str],
    html: Path | None,
    *,
    as_json: bool,
) -> None:
    """Move the session's own arm and the corrected one along the log, and compare.

    Parameters
    ----------
    topics
        Of MCAP files and rosbags, as ROLE=TOPIC.

    Raises
    ------
    ArmError, ForeignFileError, EstimateError
        If the log is faulty, or the model is not of this arm.
    """
    log = read_motion_log(motion, corrected, _roles(topics))
    said: list[str] = []

    def tell(text: str) -> None:
        said.append(text)
        say(text)

    rows = compare_with_motion(log, plain, corrected, model, load_mujoco(), tell)
    follows = [text for text in said if text.startswith(FOLLOWS)]
    notes = [*follows, *_notes(log, follows_commands=bool(follows)), *_unmoved(rows)]
    if html is not None:
        replace_text(html, motion_page(corrected.name, rows, notes))
    if as_json:
        points = [
            {
                "point": r.point,
                "error_before": r.error_before,
                "error_after": r.error_after,
                "simulated_over_measured": r.moved,
            }
            for r in rows
        ]
        band = list(rows[0].band_hz)
        print_json({"arm": corrected.name, "band_hz": band, "points": points, "notes": notes})
        return
    low, high = rows[0].band_hz
    table = Table(title=f"Accelerations in MuJoCo beside the log, {low:.1f} to {high:.0f} Hz")
    for column in ("point", "plain arm off", "corrected arm off"):
        table.add_column(column, justify="right")
    for row in rows:
        table.add_row(
            row.point, f"{100 * row.error_before:.1f} %", f"{100 * row.error_after:.1f} %"
        )
    out.print(table)
    for note in notes:
        print_note(note)
    if html is not None:
        out.print(f"page {html}")
    say_next("export ARM --mjcf OUT --from YOURS", "writes the corrected model")


def _unmoved(rows: Sequence[PointComparison]) -> list[str]:
    return [
        f"the drives' motion makes the sensor at point {row.point} read {100 * row.moved:.0f} % of "
        "what it reads: the arm stands, or something else shakes it"
        for row in rows
        if row.moved < _LITTLE
    ]


def _roles(topics: Sequence[str]) -> dict[str, str]:
    """Return topics by what they are.

    Raises
    ------
    ForeignFileError
        If one is not told as ROLE=TOPIC, or a role twice; all such are named.
    """
    found: dict[str, str] = {}
    wrong = []
    for text in topics:
        role, _, topic = text.partition("=")
        if not (role and topic) or role in found:
            wrong.append(text)
        found[role] = topic
    if wrong:
        raise ForeignFileError(
            "--topic: wanted ROLE=TOPIC, each role once, such as encoder=/joint_states or "
            f"7=/imu/data for point 7, got {', '.join(wrong)}"
        )
    return found


def _notes(log: MotionLog, *, follows_commands: bool) -> list[str]:
    notes = []
    if log.encoder_rad is None:
        notes.append("no encoder angles of all joints: the drives follow the commands exactly")
    elif log.command_rad is not None and not follows_commands:
        off = np.rad2deg(np.sqrt(np.mean((log.encoder_rad - log.command_rad) ** 2, axis=0)))
        notes.append(
            f"the drives follow the encoders; they are off the commands by {off.max():.2g} deg rms "
            "at most"
        )
    if log.slowest_hz < 0.99 * log.rate_hz:
        notes.append(
            f"logged at {log.slowest_hz:.0f} to {log.rate_hz:.0f} Hz: brought to the fastest, the "
            "band ends by the slowest"
        )
    if log.unused:
        more = len(log.unused) - _TOLD
        told = f"{', '.join(log.unused[:_TOLD])}{f' and {more} more' if more > 0 else ''}"
        notes.append(f"not used: {told}")
    return [*notes, *log.notes]
