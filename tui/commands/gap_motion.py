"""`armodal gap --simulator mujoco --motion`: a logged trajectory in the user's own simulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.table import Table

from armodal.analyzer.export.by_mujoco import load_mujoco
from armodal.analyzer.simulator.motion import beside_motion
from armodal.protocols.arm.records import Arm
from armodal.protocols.foreign.motion_log import MotionLog, read_motion_log
from armodal.tui.console import out, print_json, say, say_next

__all__ = ["show_motion"]


def show_motion(plain: Arm, corrected: Arm, model: Path, motion: Path, *, as_json: bool) -> None:
    """Move the session's own arm and the corrected one along the log, and compare.

    Raises
    ------
    ArmError, ForeignFileError, EstimateError
        If the log is faulty, or the model is not of this arm.
    """
    log = read_motion_log(motion, corrected)
    rows = beside_motion(log, plain, corrected, model, load_mujoco(), say)
    notes = _notes(log)
    if as_json:
        points = [
            {"point": r.point, "error_before": r.error_before, "error_after": r.error_after}
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
        out.print(f"note: {note}")
    say_next("export ARM --mjcf OUT --from YOURS", "writes the corrected model")


def _notes(log: MotionLog) -> list[str]:
    notes = []
    if log.encoder_rad is None:
        notes.append("no encoder angles of all joints: the drives follow the commands exactly")
    elif log.command_rad is not None:
        off = np.rad2deg(np.sqrt(np.mean((log.encoder_rad - log.command_rad) ** 2, axis=0)))
        notes.append(
            f"the drives follow the encoders; they are off the commands by {off.max():.2g} deg rms "
            "at most"
        )
    if log.unused:
        notes.append(f"columns not used: {', '.join(log.unused)}")
    return notes
