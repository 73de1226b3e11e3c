"""`armodal arm`: an arm file from a robot description, and what is to be said of one."""

from __future__ import annotations

import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
import typer

from armodal.analyzer.own_arm.draft import (
    GRAVITY,
    Draft,
    Wanted,
    draft_arm,
    read_description,
)
from armodal.analyzer.own_arm.of_arm import checked_bodies
from armodal.analyzer.own_arm.picture import points_page
from armodal.analyzer.own_arm.plausible import doubted
from armodal.analyzer.own_arm.readme import readme_text
from armodal.analyzer.planning.made import MadePlan, made_plan
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError, EstimateError, PlanError
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensors_file import CATALOGUE, Equipment, load_equipment
from armodal.tui.command_parts.arm_links import link_rows, link_table
from armodal.tui.command_parts.arm_move import move_command
from armodal.tui.command_parts.arm_show import show_command
from armodal.tui.command_parts.mesh_folder import mesh_folder
from armodal.tui.command_parts.new_folder import check_new_folder, write_new_folder
from armodal.tui.command_parts.options import Minutes, Seed, comma_numbers
from armodal.tui.command_parts.plan_json import made_json
from armodal.tui.command_parts.plan_tables import made_lines
from armodal.tui.console import Json, err, out, print_json, progress, say

__all__ = ["app"]

Array = npt.NDArray[np.float64]

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    help="An arm of your own: from a robot description to an arm file.\n\n"
    "Example: armodal arm new ur5.urdf.xacro --mass 20.6 --yes",
)

Mass = Annotated[
    float | None,
    typer.Option(min=0.01, max=1e5, help="Mass of the whole arm by its data sheet, kg."),
]
Packages = Annotated[
    list[Path] | None, typer.Option(help="Folder with ROS packages; may be given more than once.")
]
XacroArguments = Annotated[
    list[str] | None,
    typer.Option("--arg", help="Argument of a xacro file, NAME:=VALUE; may be given repeatedly."),
]
NoMeshes = Annotated[
    bool, typer.Option("--no-meshes", help="Take capsules between the joints in place of meshes.")
]
N_TESTS = 6
_DESCRIBED = {".urdf", ".xacro", ".xml"}


app.command("show")(show_command)
app.command("move")(move_command)


@app.command("new")
def new_command(
    robot: Annotated[Path, typer.Argument(help="Robot description: .urdf, .xacro, .xml (MJCF).")],
    out_folder: Annotated[
        Path | None, typer.Option("--out", help="Folder to make, never replaced; else the name's.")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the arm; else the file's.")] = None,
    tip: Annotated[str | None, typer.Option(help="Last link that belongs to the arm.")] = None,
    mass: Mass = None,
    mount: Annotated[
        str | None, typer.Option(help="floor, ceiling, wall (base x points up), or gx,gy,gz.")
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Ask nothing, take the defaults.")] = False,
    keep_inertials: Annotated[
        bool,
        typer.Option("--keep-inertials", help="Keep inertials that are doubtful but possible."),
    ] = False,
    packages: Packages = None,
    arg: XacroArguments = None,
    no_meshes: NoMeshes = False,
    sensors: Annotated[
        Path | None, typer.Option(help="Your hammers and accelerometers, sensors.toml.")
    ] = None,
    minutes: Minutes = None,
    no_plan: Annotated[
        bool, typer.Option("--no-plan", help="Make the arm file without a plan.")
    ] = False,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Make arm file, plan and a list of what to check from a robot description.

    Example: armodal arm new ur5.urdf.xacro --mass 20.6 --yes
    """
    said = Remarks()
    arm_name = _name(name or robot.name.split(".")[0])
    folder = out_folder or Path(arm_name)
    check_new_folder(folder)
    equipment = CATALOGUE if sensors is None else load_equipment(sensors)
    wanted = _wanted(tip, mass, mount, packages, arg, no_meshes, keep_inertials)
    if not yes and on_terminal():
        wanted = _asked(robot, wanted, mount)
    draft = draft_arm(robot, arm_name, wanted, said, seed=seed)
    made = None if no_plan else _planned(draft, equipment, said, seed, minutes)
    files: dict[str, bytes] = {
        f"{arm_name}.toml": draft.arm.text.encode(),
        draft.urdf_name: (draft.arm.urdf_text or "").encode(),
        "README.md": readme_text(draft, said).encode(),
        "points.html": points_page(draft.arm, draft.bodies, _shown(draft, made)).encode(),
        **draft.meshes,
    }
    if made is not None:
        files["plan.toml"] = made.text.encode()
    write_new_folder(folder, files)
    if as_json:
        told = _told(draft, said) | {"folder": str(folder), "files": sorted(files)}
        print_json(told | {"plan": None if made is None else made_json(made)})
        return
    _print(said)
    out.print(link_table(link_rows(draft.bodies, draft.believed.guessed)))
    if made is not None:
        for line in made_lines(made):
            out.print(line)
        out.print(f"plan {folder / 'plan.toml'}")
    out.print(f"arm file {folder / arm_name}.toml")
    err.print(f"next: read {folder / 'README.md'} and check what it lists")


@app.command("check")
def check_command(
    arm: Annotated[str, typer.Argument(help="Arm file, shipped arm, or robot description.")],
    tip: Annotated[str | None, typer.Option(help="Last link that belongs to the arm.")] = None,
    mass: Mass = None,
    packages: Packages = None,
    arg: XacroArguments = None,
    no_meshes: NoMeshes = False,
    as_json: Json = False,
) -> None:
    """Check an arm: everything that is wrong or doubtful, in one run.

    Example: armodal arm check my-arm/my-arm.toml --mass 28
    """
    said = Remarks()
    path, guessed = Path(arm), []
    if path.suffix.lower() in _DESCRIBED:
        wanted = _wanted(tip, mass, None, packages, arg, no_meshes, keep_inertials=False)
        chain, bodies, _ = read_description(path, wanted, said)
        shown_name = chain.name or path.stem
    else:
        the_arm = load_arm(arm)
        shown_name = the_arm.name
        bodies = checked_bodies(the_arm, None if no_meshes else mesh_folder(arm), said)
        doubted(bodies, said, total_kg=mass)
        guessed = [j.link.name for j in the_arm.joints if j.inertial_std and j.inertial_std.guessed]
    rows = link_rows(bodies, guessed)
    doubts = said.of("doubt")
    if as_json:
        print_json({"arm": shown_name, "links": rows} | _remarks(said))
    else:
        _print(said, doubts=False)
        out.print(link_table(rows))
    if doubts:
        listed = "\n".join(f"  {doubt}" for doubt in doubts)
        raise ArmError(
            f"{arm}: {len(doubts)} doubt(s):\n{listed}\n"
            "correct the description, or let `armodal arm new` put hulls of plausible mass there"
        )
    err.print("nothing to doubt; next: `armodal arm new` or `armodal plan`")


def _shown(draft: Draft, made: MadePlan | None) -> Array:
    """The posture that the points are shown in: the plan's first, else the middle of the ranges."""
    if made is not None:
        return made.plan.tests[0].joints_rad
    return np.array([0.5 * (low + high) for low, high in (j.range_rad for j in draft.arm.joints)])


def on_terminal() -> bool:
    """Whether somebody can be asked."""
    return sys.stdin.isatty()


def _planned(
    draft: Draft, equipment: Equipment, said: Remarks, seed: int, minutes: float | None
) -> MadePlan | None:
    """A plan for the new arm; why there is none is said."""
    try:
        return made_plan(
            draft.arm,
            np.random.default_rng(seed),
            name=f"{draft.arm.name[:58]}-tests",
            bodies=draft.bodies,
            floor_m=None,
            equipment=equipment,
            n_tests=N_TESTS,
            minutes=minutes,
            progress=progress("plan"),
        )
    except (ArmError, EstimateError, PlanError) as problem:
        said.note("plan", f"none was made: {problem}")
        return None


def _wanted(
    tip: str | None,
    mass: float | None,
    mount: str | None,
    packages: list[Path] | None,
    arguments: list[str] | None,
    no_meshes: bool,
    keep_inertials: bool,
) -> Wanted:
    pairs = [text.partition(":=") for text in arguments or []]
    for key, mark, _ in pairs:
        if not mark or not key:
            raise ArmError(f"--arg: wanted NAME:=VALUE, got {key!r}")
    return Wanted(
        tip=tip,
        total_kg=mass,
        gravity_m_s2=_gravity(mount),
        keep_inertials=keep_inertials,
        use_meshes=not no_meshes,
        folders=tuple(packages or ()),
        arguments={key: value for key, _, value in pairs},
    )


def _gravity(mount: str | None) -> tuple[float, float, float]:
    if mount is None:
        return GRAVITY["floor"]
    if mount in GRAVITY:
        return GRAVITY[mount]
    if "," not in mount:
        raise ArmError(
            f"--mount: wanted {', '.join(GRAVITY)}, or gravity in the base's frame as gx,gy,gz, "
            f"got {mount!r}"
        )
    x, y, z = comma_numbers(mount, "--mount", 3)
    if not 5.0 < (x * x + y * y + z * z) ** 0.5 < 15.0:
        raise ArmError(f"--mount: wanted gravity of some 9.81 m/s², got {mount!r}")
    return x, y, z


def _asked(robot: Path, wanted: Wanted, mount: str | None) -> Wanted:
    """Ask what only the user knows: tip, mass, mounting, what to do with doubted inertials."""
    first = Remarks()
    chain, _, doubts = read_description(robot, wanted, first)
    if wanted.tip is None:
        names = [part.link.name for body in chain.bodies for part in body.parts]
        typed = typer.prompt("last link of the arm", default=chain.tip, err=True)
        if typed not in names:
            raise ArmError(f"tip: wanted one of {', '.join(names)}, got {typed!r}")
        wanted = wanted if typed == chain.tip else replace(wanted, tip=typed)
    if wanted.total_kg is None:
        typed = typer.prompt(
            "mass of the arm by its data sheet, kg, 0 if unknown", default=0.0, type=float, err=True
        )
        wanted = replace(wanted, total_kg=typed if typed > 0.0 else None)
    if mount is None:
        typed = typer.prompt("mounting: floor, ceiling, wall", default="floor", err=True)
        wanted = replace(wanted, gravity_m_s2=_gravity(typed))
    if doubts.spread and not wanted.keep_inertials:
        for doubt in first.of("doubt"):
            err.print(f"doubt: {doubt}")
        if not typer.confirm("put hulls of plausible mass in their place", default=True, err=True):
            wanted = replace(wanted, keep_inertials=True)
    return wanted


def _name(text: str) -> str:
    kept = "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "-" for c in text)
    return kept.strip("-_")[:64] or "arm"


def _print(said: Remarks, *, doubts: bool = True) -> None:
    for remark in said.of("note"):
        say(str(remark))
    for remark in said.of("guess", *(("doubt",) if doubts else ())):
        err.print(f"{remark.kind}: {remark}")


def _remarks(said: Remarks) -> dict[str, Any]:
    kinds = {"doubts": "doubt", "guesses": "guess", "notes": "note"}
    return {key: [str(one) for one in said.of(kind)] for key, kind in kinds.items()}


def _told(draft: Draft, said: Remarks) -> dict[str, Any]:
    return {
        "arm": draft.arm.name,
        "tip": draft.chain.tip,
        "joints": [joint.name for joint in draft.arm.joints],
        "links": link_rows(draft.bodies, draft.believed.guessed),
        "points": {
            body.name: [point.id for point in draft.points if point.body == number]
            for number, body in enumerate(draft.bodies)
        },
        "tolerances": {
            "mass": draft.believed.mass,
            "inertia": draft.believed.inertia,
            "center_m": draft.believed.center_m,
            "moving_mass": draft.believed.moving_mass,
            "links": [asdict(std) for std in draft.believed.stds],
        },
    } | _remarks(said)
