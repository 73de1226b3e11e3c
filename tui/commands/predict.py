"""`armodal predict`: the modes that an identified session predicts in any posture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.predicted_posture import Prediction, predict_posture
from armodal.analyzer.identification.scatter import half_width_95
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.command_parts.arm_prediction import arm_prediction_json, arm_prediction_table
from armodal.tui.command_parts.options import comma_numbers, refuse_idle
from armodal.tui.console import Json, out, print_json, print_note, say, say_next
from armodal.tui.deviation import deviation

__all__ = ["app"]

app = typer.Typer(add_completion=False)


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
            deviation(found.f_std_hz[i]),
            deviation(tolerated.f_std_hz[i]),
            f"{100 * found.modes.damping_ratio[i]:.3f}",
            deviation(100 * found.damping_std[i]),
            deviation(100 * tolerated.damping_std[i]),
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


@app.command("predict")
def predict_command(
    context: typer.Context,
    posture: Annotated[
        list[str],
        typer.Option(help="Joint angles in degrees, separated by commas; repeatable."),
    ],
    session: Annotated[Path | None, typer.Argument(help="Session file (.h5).")] = None,
    arm: Annotated[
        str | None,
        typer.Option("--arm", help="Instead: an arm file with its effects, or a shipped arm."),
    ] = None,
    level: Annotated[
        float,
        typer.Option(
            help="With --arm: peak force over the test's middle one, where a law depends on it."
        ),
    ] = 1.0,
    below: Annotated[
        float, typer.Option(help="With --arm: modes up to this frequency, Hz.", min=0.0)
    ] = 1000.0,
    as_json: Json = False,
) -> None:
    """Frequency, damping and shape in any posture, of a session or of a corrected arm file.

    Example: armodal predict --arm demo/demo.arm.toml --posture=0,30,30,0,90,0 --json
    """
    asked = [comma_numbers(text, "--posture") for text in posture]
    if (session is None) == (arm is None):
        raise ArmError(
            "wanted either a session, whose own fit predicts, or --arm with an arm file, got "
            f"{'neither' if arm is None else 'both'}; give one, such as "
            "`armodal predict --arm demo/demo.arm.toml --posture=0,30,30,0,90,0`"
        )
    if session is None:
        _of_arm(arm or "", asked, level, below, as_json=as_json)
        return
    refuse_idle(context, ("level", "below"), here="a session", there="--arm")
    _of_session(session, asked, as_json=as_json)


def _of_arm(
    source: str, asked: list[list[float]], level: float, below: float, *, as_json: bool
) -> None:
    if not level > 0.0:
        raise ArmError(f"--level: wanted a positive ratio of forces, got {level:g}; 1 is the test")
    arm = load_arm(source)
    found = predict_arm(arm, asked, level=math.log(level), below_hz=below)
    effects = [f"{effect.name} ({effect.place})" for effect in arm.effects]
    notes = list(found[0].notes)
    if as_json:
        rows = [arm_prediction_json(prediction) for prediction in found]
        print_json({"arm": arm.name, "effects": effects, "postures": rows, "notes": notes})
        return
    out.print(f"with {', '.join(effects)}" if effects else "no effects in the arm file")
    for prediction in found:
        out.print(arm_prediction_table(prediction))
    for note in notes:
        print_note(note)
    posture = ",".join(f"{angle:g}" for angle in asked[0])
    say_next(f"shaper {source} --posture={posture}", "a path that does not excite these modes")


def _of_session(session: Path, asked: list[list[float]], *, as_json: bool) -> None:
    measured = read_session(session)
    arm = measured.header.arm
    for angles in asked:
        wanted_posture(arm, angles)  # before minutes are spent on the fit
    result = identify(measured, say)
    found = [predict_posture(arm, result, angles) for angles in asked]
    doubts = [f"axis in {axis.link}: {doubt}" for axis in result.axes for doubt in axis.doubts]
    notes = [*result.notes, *doubts, *measured.warnings]
    if as_json:
        rows = [prediction_json(prediction) for prediction in found]
        print_json({"arm": arm.name, "postures": rows, "notes": notes})
        return
    for prediction in found:
        for table in prediction_tables(prediction):
            out.print(table)
    for note in notes:
        print_note(note)
    say_next(f"report {session}", "holds predictions against postures that were measured")
