"""The demo's last step: the corrected arm in MuJoCo, beside what was measured to check it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy
from rich.table import Table

from armodal.analyzer.export.by_mujoco import load_mujoco, simulator_frequencies
from armodal.analyzer.export.exported import ready_for_export
from armodal.analyzer.export.mjcf import mjcf_text
from armodal.analyzer.identification.records import Identification
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import MissingPackageError
from armodal.protocols.session.records import Session
from armodal.tui.command_parts.export_arm import export_arm

__all__ = ["simulator_lines", "simulator_table", "through_the_simulator"]

Array = npt.NDArray[np.float64]


def through_the_simulator(
    session: Session, result: Identification, arm_path: Path, directory: Path
) -> dict[str, Any]:
    """Export the corrected arm and set its frequencies in MuJoCo beside those measured.

    Only postures kept for validation: `armodal identify` never fits to them. The gap workflow holds
    some out to judge a name, and fits what it named to all.
    """
    began = time.monotonic()
    try:
        mujoco: Any = load_mujoco()
    except MissingPackageError as missing:
        return {"skipped": str(missing)}
    arms = {"before": session.header.arm, "after": load_arm(str(arm_path))}
    model_path = directory / "demo.mjcf.xml"
    written = export_arm(str(arm_path), mjcf=model_path, urdf=None, sdf=None, own=None)
    held_out = {p.name for p in session.header.plan.postures if p.validation}
    rows: list[dict[str, Any]] = []
    for frf, modal in zip(result.frfs, result.modal_models, strict=True):
        if frf.posture not in held_out or frf.joints_rad is None:
            continue
        measured = np.array(sorted(mode.f_hz for mode in modal.modes))
        found = {
            when: _paired(measured, _frequencies(mujoco, arm, model_path, when, frf.joints_rad))
            for when, arm in arms.items()
        }
        rows += [
            {
                "posture": frf.posture,
                "measured_hz": float(f_hz),
                **{f"{when}_hz": found[when][i] for when in arms},
            }
            for i, f_hz in enumerate(measured)
        ]
    return {
        "model": str(model_path),
        "mujoco": written["mujoco"],
        "modes": rows,
        "seconds": time.monotonic() - began,
    }


def _frequencies(mujoco: Any, arm: Arm, path: Path, when: str, joints_rad: Array) -> Array:
    """Natural frequencies of an arm in MuJoCo; the corrected one is loaded from its file."""
    tree = ready_for_export(arm).tree
    model = (
        mujoco.MjModel.from_xml_path(str(path))
        if when == "after"
        else mujoco.MjModel.from_xml_string(mjcf_text(arm, tree))
    )
    angles = dict(zip((j.name for j in arm.joints), joints_rad.tolist(), strict=True))
    return simulator_frequencies(mujoco, model, tree.elastic, angles)


def _paired(measured: Array, model: Array) -> list[float | None]:
    """The model's frequency for each measured one; None where the model has too few modes."""
    apart = np.abs(np.log(measured[:, None] / model[None, :]))
    rows, columns = scipy.optimize.linear_sum_assignment(apart)
    found: list[float | None] = [None] * len(measured)
    for i, j in zip(rows, columns, strict=True):
        found[int(i)] = float(model[j])
    return found


def simulator_table(found: dict[str, Any]) -> Table:
    """Measured and simulated frequencies of the validation postures."""
    table = Table(title="In MuJoCo, beside what was measured in the validation postures")
    for column in ("posture", "measured Hz", "plain arm Hz", "off %", "corrected Hz", "off %"):
        table.add_column(column, justify="right")
    for row in found["modes"]:
        cells = [row["posture"], f"{row['measured_hz']:.2f}"]
        for when in ("before", "after"):
            own = row[f"{when}_hz"]
            off = None if own is None else 100.0 * (own / row["measured_hz"] - 1.0)
            cells += ["none", ""] if own is None else [f"{own:.2f}", f"{off:+.2f}"]
        table.add_row(*cells)
    return table


def simulator_lines(found: dict[str, Any]) -> list[str]:
    """What was written and how well it agrees."""
    if "skipped" in found:
        return [f"no simulator: {found['skipped']}"]
    worst = {
        when: max(
            (
                abs(row[f"{when}_hz"] / row["measured_hz"] - 1.0)
                for row in found["modes"]
                if row[f"{when}_hz"] is not None
            ),
            default=0.0,
        )
        for when in ("before", "after")
    }
    off = (
        f"in MuJoCo the plain arm is off by up to {100 * worst['before']:.1f} %, the corrected one "
        f"by {100 * worst['after']:.2f} %"
    )
    return [off, f"{found['seconds']:.0f} s; corrected model {found['model']}"]
