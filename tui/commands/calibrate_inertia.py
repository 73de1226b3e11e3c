"""`armodal calibrate-inertia`: link inertias from published or measured figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

from armodal.analyzer.calibration.calibrate import Calibration
from armodal.analyzer.calibration.from_file import calibrate_from_file
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.arm.rewrite import text_with_inertials
from armodal.protocols.errors import ArmError
from armodal.protocols.inertia_targets import load_inertia_targets
from armodal.protocols.text_file import write_new_text
from armodal.tui.command_parts.options import ArmName
from armodal.tui.console import Json, out, print_json, say, say_next

__all__ = ["app"]

app = typer.Typer(add_completion=False)

IN_TENSION = 1.0  # margins
_TWIN = "Another arm is equally probable (`twin` with --json); uncertainties are about this one."


def calibrate(arm_source: str, targets_path: Path, name: str) -> tuple[Calibration, str]:
    """Calibrate an arm and return the result with the text of the new arm file.

    Raises
    ------
    ArmError, EstimateError
        As reading and calibrating do.
    """
    arm = load_arm(arm_source)
    file = load_inertia_targets(targets_path, arm)
    found = calibrate_from_file(arm, file)
    source = f"{arm.source} Inertials: calibrated to {targets_path.name} ({file.source})."
    links = [joint.link for joint in found.arm.joints]
    return found, text_with_inertials(arm.text, links, name=name, source=source)


def calibration_json(found: Calibration) -> dict[str, Any]:
    """Links with their belief, targets with their pulls, and what stays undetermined."""
    undetermined = found.undetermined()
    return {
        "links": [
            {
                "link": joint.link.name,
                "mass_kg": joint.link.mass_kg,
                "believed_mass_kg": body.mass_kg,
                "center_m": joint.link.center_m.tolist(),
                "inertia_kg_m2": joint.link.inertia_kg_m2.tolist(),
                "radii_of_gyration_m": _radii(found.arm, i).tolist(),
                "undetermined": list(undetermined[body.name]),
            }
            for i, (joint, body) in enumerate(zip(found.arm.joints, found.bodies, strict=True))
        ],
        "base_mass_kg": found.base_mass_kg,
        "twin": None
        if found.twin is None
        else [
            {
                "mass_kg": link.mass_kg,
                "center_m": link.center_m.tolist(),
                "inertia_kg_m2": link.inertia_kg_m2.tolist(),
            }
            for link in found.twin
        ],
        "targets": [
            {"source": target.source, "pulls_in_margins": pulls.tolist()}
            for target, pulls in found.pulls
        ],
    }


def calibration_tables(found: Calibration) -> list[Table]:
    """Links and targets as tables for people."""
    links = Table(title="Calibrated links", caption=_TWIN if found.twin is not None else None)
    for column in ("link", "mass kg", "arm file", "radii of gyration mm", "undetermined"):
        links.add_column(column, justify="left" if column == "undetermined" else "right")
    undetermined = found.undetermined()
    for i, (joint, body) in enumerate(zip(found.arm.joints, found.bodies, strict=True)):
        links.add_row(
            joint.link.name,
            f"{joint.link.mass_kg:.3f}",
            f"{body.mass_kg:.3f}",
            " ".join(f"{1e3 * radius:.0f}" for radius in _radii(found.arm, i)),
            ", ".join(undetermined[body.name]) or "nothing",
        )
    targets = Table(title="Targets, deviation in margins")
    for column in ("figure", "deviations", ""):
        targets.add_column(column)
    for target, pulls in found.pulls:
        tense = np.abs(pulls).max(initial=0.0) > IN_TENSION
        targets.add_row(
            target.source, " ".join(f"{pull:+.2f}" for pull in pulls), "in tension" if tense else ""
        )
    return [links, targets]


def _radii(arm: Arm, link: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Principal radii of gyration, largest first."""
    body = arm.joints[link].link
    principal = np.linalg.eigvalsh(body.inertia_kg_m2)[::-1]
    return np.asarray(np.sqrt(principal / body.mass_kg))


@app.command("calibrate-inertia")
def calibrate_command(
    arm: ArmName,
    targets: Annotated[Path, typer.Argument(help="Inertia targets file.")],
    out_path: Annotated[Path, typer.Option("--out", help="Arm file to write, never replaced.")],
    name: Annotated[
        str | None, typer.Option(help="Name of the new arm; by default the file's.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Find link inertias that meet given targets, nearest to the arm file's.

    Example: armodal calibrate-inertia my-arm.toml targets.toml --out my-arm-calibrated.toml
    """
    say("the likeliest inertias, from either side of the belief")
    found, text = calibrate(arm, targets, name or out_path.stem)
    write_new_text(out_path, text, error=ArmError)
    if as_json:
        print_json(calibration_json(found) | {"arm": str(out_path)})
        return
    for table in calibration_tables(found):
        out.print(table)
    out.print(f"arm {out_path}")
    say_next(f"plan {out_path}")
