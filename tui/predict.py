"""`armodal predict`: the modes an identified session predicts in any posture."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.table import Table

from armodal.analyzer.identification.predicted_posture import Prediction
from armodal.analyzer.identification.scatter import half_width_95

__all__ = ["prediction_json", "prediction_tables"]


def prediction_json(prediction: Prediction) -> dict[str, Any]:
    """The modes of one posture as plain values."""
    found, tolerated = prediction.predicted, prediction.from_tolerances
    moved = found.model.point_jacobian[:, :3] @ found.shape
    return {
        "posture_deg": list(prediction.posture_deg),
        "modes": [
            {
                "f_hz": float(found.modes.f_hz[i]),
                "f_std_hz": float(found.f_std_hz[i]),
                "f_half_width_95_hz": half_width_95(
                    float(found.f_std_hz[i]), float(found.f_dof[i])
                ),
                "f_std_model_hz": float(tolerated.f_std_hz[i]),
                "damping_ratio": float(found.modes.damping_ratio[i]),
                "damping_std": float(found.damping_std[i]),
                "damping_std_model": float(tolerated.damping_std[i]),
                "strain_share": dict(
                    zip(prediction.freedoms, found.strain_share[:, i].tolist(), strict=True)
                ),
                "shape": {
                    name: {
                        "real": float(found.shape[row, i].real),
                        "imag": float(found.shape[row, i].imag),
                        "std": float(found.shape_std[row, i]),
                        "std_model": float(tolerated.shape_std[row, i]),
                    }
                    for row, name in enumerate(prediction.freedoms)
                },
                "point_shape_m_per_rad": {
                    point.id: {
                        "real": moved[row, :, i].real.tolist(),
                        "imag": moved[row, :, i].imag.tolist(),
                    }
                    for row, point in enumerate(prediction.arm.points)
                },
            }
            for i in range(found.modes.f_hz.size)
        ],
    }


def prediction_tables(prediction: Prediction) -> list[Table]:
    """The modes of one posture as tables for people."""
    found, tolerated = prediction.predicted, prediction.from_tolerances
    posture = " ".join(f"{angle:g}" for angle in prediction.posture_deg)
    modes = Table(
        title=f"Predicted at {posture} deg (± from scatter, ± from the arm's tolerances)",
        title_justify="left",
    )
    for column in ("mode", "f Hz", "± scatter", "± model", "damping %", "± scatter", "± model"):
        modes.add_column(column, justify="right")
    for i, f_hz in enumerate(found.modes.f_hz):
        modes.add_row(
            str(i + 1),
            f"{f_hz:.3f}",
            f"{found.f_std_hz[i]:.3f}",
            f"{tolerated.f_std_hz[i]:.3f}",
            f"{100 * found.modes.damping_ratio[i]:.3f}",
            f"{100 * found.damping_std[i]:.3f}",
            f"{100 * tolerated.damping_std[i]:.3f}",
        )
    shapes = Table(
        title="Shapes: turn of each, 1 in the largest, and its part of the strain energy",
        title_justify="left",
    )
    shapes.add_column("")
    for i in range(found.modes.f_hz.size):
        shapes.add_column(f"mode {i + 1}", justify="right")
    both = np.hypot(found.shape_std, tolerated.shape_std)
    for row, name in enumerate(prediction.freedoms):
        shapes.add_row(
            name,
            *(
                f"{found.shape[row, i].real:+.3f} ± {both[row, i]:.3f}\n"
                f"{100 * found.strain_share[row, i]:.1f} %"
                for i in range(found.modes.f_hz.size)
            ),
        )
    return [modes, shapes]
