"""Modes of a corrected arm file: as a table for people and an object for machines."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from armodal.analyzer.corrected.prediction import ArmPrediction
from armodal.tui.deviation import deviation

__all__ = ["arm_prediction_json", "arm_prediction_table"]


def arm_prediction_json(found: ArmPrediction) -> dict[str, Any]:
    """The modes of one posture as plain values."""
    names = found.posture.names
    return {
        "posture_deg": list(found.posture_deg),
        "modes": [
            {
                "f_hz": float(found.modes.f_hz[i]),
                "f_std_hz": float(found.f_std_hz[i]),
                "damping_ratio": float(found.modes.damping_ratio[i]),
                "damping_std": float(found.damping_std[i]),
                "strain_share": dict(zip(names, found.strain_share[:, i].tolist(), strict=True)),
            }
            for i in range(found.modes.f_hz.size)
        ],
    }


def arm_prediction_table(found: ArmPrediction) -> Table:
    """The modes of one posture, and which spring holds most of each."""
    posture = " ".join(f"{angle:g}" for angle in found.posture_deg)
    table = Table(
        title=f"Predicted at {posture} deg (± from the arm file's deviations)",
        title_justify="left",
    )
    for column in ("mode", "f Hz", "±", "damping %", "±"):
        table.add_column(column, justify="right")
    table.add_column("most strain in")
    for i, f_hz in enumerate(found.modes.f_hz):
        share = found.strain_share[:, i]
        most = int(share.argmax())
        table.add_row(
            str(i + 1),
            f"{f_hz:.3f}",
            deviation(found.f_std_hz[i]),
            f"{100 * found.modes.damping_ratio[i]:.3f}",
            deviation(100 * found.damping_std[i]),
            f"{found.posture.names[most]} ({100 * share[most]:.0f} %)",
        )
    return table
