"""`armodal plan`: which postures, hits and points to measure."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from armodal.analyzer.own_arm.of_arm import checked_bodies
from armodal.analyzer.planning.compared_plan import plan_to_compare
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.made import made_plan
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlanError
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensors_file import CATALOGUE, load_equipment
from armodal.protocols.text_file import write_new_text
from armodal.tui.command_parts.mesh_folder import mesh_folder
from armodal.tui.command_parts.options import ArmName, Minutes, Seed
from armodal.tui.command_parts.plan_json import made_json, plan_json
from armodal.tui.command_parts.plan_tables import made_lines, plan_tables
from armodal.tui.console import Json, err, out, print_json, print_note, progress, say_next

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command("plan")
def plan_command(
    arm: ArmName,
    tests: Annotated[int, typer.Option(min=1, max=50, help="Tests wanted in all.")] = 6,
    minutes: Minutes = None,
    out_path: Annotated[
        Path | None, typer.Option("--out", help="Plan file to write, never replaced.")
    ] = None,
    name: Annotated[str, typer.Option(help="Name of the plan in that file.")] = "selective",
    floor: Annotated[
        float | None,
        typer.Option(help="Height of the floor, m in base; else the arm file's keep-outs, or 0."),
    ] = None,
    sensors: Annotated[
        Path | None, typer.Option(help="Your hammers and accelerometers, sensors.toml.")
    ] = None,
    beside: Annotated[
        str | None,
        typer.Option(help="Plan to compare with; else the arm's shipped plan, if it has one."),
    ] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Plan a test: the fewest postures that identify the joints first, then the most informative.

    Example: armodal plan viper_s650 --out viper-plan.toml
    """
    the_arm = load_arm(arm)
    planned = planned_arm(the_arm)
    other = plan_to_compare(planned, beside)
    made = made_plan(
        the_arm,
        np.random.default_rng(seed),
        name=name,
        bodies=checked_bodies(the_arm, mesh_folder(arm), Remarks()),
        floor_m=floor,
        equipment=CATALOGUE if sensors is None else load_equipment(sensors),
        n_tests=tests,
        minutes=minutes,
        progress=progress("search"),
    )
    found = made.plan
    if out_path is not None:
        write_new_text(out_path, made.text, error=PlanError)
    if as_json:
        told = plan_json(found, other) | made_json(made)
        file = None if out_path is None else str(out_path)
        print_json(told | {"notes": list(planned.notes), "plan": file})
        return
    for table in plan_tables(found, other, made.inertia_std):
        out.print(table)
    for line in made_lines(made):
        out.print(line)
    if found.not_isolated:
        names = ", ".join(the_arm.joints[joint].name for joint in found.not_isolated)
        out.print(f"no test shows {names} alone: identify by the fit of all modes")
    for note in planned.notes:
        print_note(note)
    if out_path is not None:
        out.print(f"plan {out_path}")
        say_next(f"run {out_path} --arm {arm}")
    else:
        err.print("next: give --out FILE to write the plan")
