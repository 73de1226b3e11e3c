"""Commands that need an arm and no measurement: plan, mozzi, workspace, calibrate, reproduce."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from armodal.analyzer.planning.beside import other_plan
from armodal.analyzer.planning.clearance import Clearance
from armodal.analyzer.planning.plan_text import plan_text
from armodal.analyzer.planning.selective import plan_tests
from armodal.analyzer.workspace.spectrum import elastic_joints
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError, PlanError
from armodal.protocols.text_file import write_new_text
from armodal.tui.calibrate import calibrate, calibration_json, calibration_tables
from armodal.tui.console import Json, err, out, print_json, progress, say
from armodal.tui.mozzi import (
    Elbow,
    deflection_json,
    deflection_tables,
    load_tool,
    posture_of_wrist,
    rank_random_postures,
)
from armodal.tui.plan import plan_json
from armodal.tui.plan_tables import plan_tables
from armodal.tui.reproduce import figure_json, figure_tables, reproduce_papers
from armodal.tui.workspace import survey_to_files, workspace_table

__all__ = ["app", "comma_numbers"]

app = typer.Typer(add_completion=False)

ArmName = Annotated[str, typer.Argument(help="Arm file, or a shipped arm such as rv4frl.")]
Seed = Annotated[int, typer.Option(min=0, help="For everything random.")]


def comma_numbers(text: str, what: str, count: int | None = None) -> list[float]:
    """The numbers of an option such as 0,30,-45.

    Raises
    ------
    ArmError
        If they are not finite numbers, or not `count` of them.
    """
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if not values or not np.isfinite(values).all() or (count and len(values) != count):
        wanted = f"{count} numbers" if count else "numbers"
        raise ArmError(f"{what}: wanted {wanted} separated by commas, got {text!r}")
    return values


def _plain_arm(source: str) -> Arm:
    """Load an arm for a calculation that knows only its links and joints, and say so."""
    arm = load_arm(source)
    for note in arm.effects_left_out():
        err.print(f"note: {note}")
    return arm


@app.command("plan")
def plan_command(
    arm: ArmName,
    tests: Annotated[int, typer.Option(min=1, max=50, help="Tests wanted in all.")] = 6,
    out_path: Annotated[
        Path | None, typer.Option("--out", help="Plan file to write, never replaced.")
    ] = None,
    name: Annotated[str, typer.Option(help="Name of the plan in that file.")] = "selective",
    floor: Annotated[float, typer.Option(help="Height of the floor, m in base.")] = 0.0,
    base_radius: Annotated[float, typer.Option(min=0, help="Kept clear round the base, m.")] = 0.12,
    beside: Annotated[
        str | None,
        typer.Option(help="Plan to compare with; else the arm's shipped plan, if it has one."),
    ] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Which postures, hits and points identify the joints: the fewest, then the most telling.

    Example: armodal plan viper_s650 --out viper-plan.toml
    """
    the_arm = _plain_arm(arm)
    elastic = elastic_joints(the_arm)
    other = other_plan(the_arm, elastic, beside)
    found = plan_tests(
        the_arm,
        elastic,
        np.random.default_rng(seed),
        clearance=Clearance(floor_m=floor, base_radius_m=base_radius),
        n_tests=tests,
        progress=progress("search"),
    )
    if out_path is not None:
        write_new_text(out_path, plan_text(found, name), error=PlanError)
    if as_json:
        print_json(plan_json(found, other) | {"plan": None if out_path is None else str(out_path)})
        return
    for table in plan_tables(found, other):
        out.print(table)
    if found.not_isolated:
        names = ", ".join(the_arm.joints[joint].name for joint in found.not_isolated)
        out.print(f"no test shows {names} alone: identify by the fit of all modes")
    if out_path is not None:
        out.print(f"plan {out_path}")


@app.command("mozzi")
def mozzi_command(
    arm: ArmName,
    wrench: Annotated[str, typer.Option(help="fx,fy,fz,mx,my,mz at the tool, base axes, N, N m.")],
    posture: Annotated[
        str | None, typer.Option(help="Joint angles in degrees, separated by commas.")
    ] = None,
    wrist: Annotated[
        str | None,
        typer.Option(help="Instead: wrist at horizontal,vertical m of the meridian plane."),
    ] = None,
    elbow: Annotated[Elbow, typer.Option(help="Which way, with --wrist.")] = Elbow.UP,
    at: Annotated[
        str, typer.Option(help="Tool point x,y,z in the last link's frame, m.")
    ] = "0,0,0",
    rank: Annotated[
        int,
        typer.Option(
            min=0, max=10_000_000, help="Instead of one posture: rank so many random ones."
        ),
    ] = 0,
    best: Annotated[int, typer.Option(min=1, help="How many of them to show.")] = 10,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """How the tool gives under a load: displacement, Mozzi axis, each joint's part.

    Example: armodal mozzi viper_s650 --posture 0,0,60,0,40,0 --wrench 0,50,-100,0,0,0 --at 0,0,0.1
    """
    the_arm = _plain_arm(arm)
    load, tool = comma_numbers(wrench, "--wrench", 6), comma_numbers(at, "--at", 3)
    if rank:
        rows = rank_random_postures(the_arm, load, tool, n=rank, best=best, seed=seed)
        if as_json:
            print_json({"arm": the_arm.name, "postures": rows})
            return
        for row in rows:
            angles = " ".join(f"{angle:7.1f}" for angle in row["posture_deg"])
            out.print(f"{1e3 * row['displacement_m']:9.4f} mm  at {angles} deg")
        return
    if (posture is None) == (wrist is None):
        raise ArmError(
            "wanted one of --posture with the joint angles in degrees, --wrist with its place in "
            f"the meridian plane, and --rank; got {'none' if posture is None else 'two'}"
        )
    if wrist is not None:
        asked = posture_of_wrist(the_arm, comma_numbers(wrist, "--wrist", 2), elbow)
    else:
        asked = comma_numbers(posture or "", "--posture")
    found, lines = load_tool(the_arm, asked, load, tool)
    if as_json:
        print_json(
            {"arm": the_arm.name, "posture_deg": asked} | deflection_json(the_arm, found, lines)
        )
        return
    for table in deflection_tables(the_arm, found, lines):
        out.print(table)


@app.command("workspace")
def workspace_command(
    arm: ArmName,
    postures: Annotated[int, typer.Option(min=1, max=100_000_000)] = 100_000,
    directory: Annotated[Path, typer.Option("--out", help="Folder for page and arrays.")] = Path(
        "workspace"
    ),
    workers: Annotated[int, typer.Option(min=1, max=1024, help="Processes that share it.")] = 1,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Mass matrix, frequencies and damping over random postures; maps over the wrist's position.

    Example: armodal workspace viper_s650 --postures 1000000
    """
    value, study = survey_to_files(
        load_arm(arm),
        directory,
        n_postures=postures,
        seed=seed,
        workers=workers,
        progress=progress("postures"),
    )
    if as_json:
        print_json(value)
        return
    out.print(workspace_table(study))
    for note in value["notes"]:
        out.print(f"note: {note}")
    out.print(f"page   {value['page']}\narrays {value['arrays']}")


@app.command("calibrate-inertia")
def calibrate_command(
    arm: ArmName,
    targets: Annotated[Path, typer.Argument(help="Inertia targets file.")],
    out_path: Annotated[Path, typer.Option("--out", help="Arm file to write, never replaced.")],
    name: Annotated[str | None, typer.Option(help="Name of the new arm; the file's stem.")] = None,
    as_json: Json = False,
) -> None:
    """Link inertias that meet given figures, nearest to what is believed of the links.

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


@app.command("reproduce")
def reproduce_command(
    postures: Annotated[int, typer.Option(min=1000, max=100_000_000)] = 1_000_000,
    as_json: Json = False,
) -> None:
    """Every published figure of the three papers beside ours, with margin and status.

    Example: armodal reproduce --json
    """
    figures = reproduce_papers(postures, say)
    if as_json:
        rows: list[dict[str, Any]] = [figure_json(figure) for figure in figures]
        print_json({"figures": rows})
        return
    for table in figure_tables(figures):
        out.print(table)
