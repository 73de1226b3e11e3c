"""`armodal run`: the operator's app."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from armodal import SOFTWARE
from armodal.daq.front_end.opening import is_front_end
from armodal.hil_sim.rehearsed_plant import parse_hidden
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import SessionError
from armodal.protocols.front_end import load_front_end
from armodal.protocols.plan import load_plan
from armodal.protocols.sensor_memory import load_sensors
from armodal.tui.command_parts.joint_angles import JointAngles, joint_angles, with_controllers
from armodal.tui.command_parts.journey import go_from
from armodal.tui.command_parts.options import (
    ByHand,
    MeasuredBy,
    Mirror,
    one_board,
    say_if_on_one_disk,
    sensor_memory,
)
from armodal.tui.command_parts.rehearsed import plan_to_rehearse, spoken_arm
from armodal.tui.console import TimeScale, check_terminal, err, say_next
from armodal.tui.screens.run.app import RunApp
from armodal.tui.screens.run.earlier import earlier_frfs
from armodal.tui.screens.run.options import RunOptions
from armodal.tui.screens.run.place import find_place
from armodal.tui.screens.wishes import Look

__all__ = ["app", "run_app"]

app = typer.Typer(add_completion=False)


def run_app(
    *,
    plan: str | None,
    arm: str | Arm,
    session: Path,
    simulated: bool,
    mirror: Path | None = None,
    measured_by: str = "",
    board: str = "",
    can: str = "",
    angles: JointAngles = JointAngles(),  # noqa: B008 - frozen
    baud: int = 921_600,
    seed: int = 1,
    time_scale: float = 1.0,
    input_range_v: float | None = None,
    hide: Sequence[str] = (),
    earlier: Path | None = None,
    std_wanted_percent: float | None = None,
) -> tuple[int, Look | None]:
    """Run the app to its end, and say what was written.

    Returns
    -------
    exit code, and the session to look at if the app was left for that

    Raises
    ------
    ArmodalError
        If arm, plan, an existing journal or the input range cannot be used.
    """
    if input_range_v is not None and not 0.0 < input_range_v < math.inf:
        raise SessionError(
            "--input-range: wanted the largest input voltage of the board in V, above 0, got "
            f"{input_range_v:g}; its data sheet tells it"
        )
    if hide and not simulated:
        raise SessionError("wanted --hide with --sim only, got a real arm; leave it out")
    hidden = parse_hidden(hide)
    the_arm = load_arm(arm) if isinstance(arm, str) else arm
    the_plan = None if plan is None else load_plan(plan, the_arm)
    if simulated and not session.exists():
        the_arm = spoken_arm(the_arm)
        the_plan = the_plan or plan_to_rehearse(the_arm)
    if input_range_v is None and is_front_end(board):
        input_range_v = load_front_end(Path(board)).range_v
    memory = None if simulated else sensor_memory()
    place = find_place(session, the_arm, the_plan)
    options = RunOptions(
        place=place,
        arm_folder=Path(arm).parent if isinstance(arm, str) else None,
        earlier=() if earlier is None else earlier_frfs(earlier, place.arm),
        std_wanted=None if std_wanted_percent is None else std_wanted_percent / 100.0,
        mirror=mirror,
        measured_by=measured_by,
        board=board,
        can=can,
        told_rad=angles.told_rad,
        controller=angles.controller,
        baud=baud,
        input_range_v=input_range_v,
        sensor_memory=memory,
        known_sensors=load_sensors(memory) if memory else {},
        simulated=simulated,
        hidden=hidden,
        seed=seed,
        time_scale=time_scale,
        software=SOFTWARE,
    )
    say_if_on_one_disk(session, mirror)
    app = RunApp(options)
    app.run()
    _say_what_was_written(app)
    return app.return_code or 0, app.wish


def _say_what_was_written(app: RunApp) -> None:
    state, place = app.state, app.conductor.place
    if not place.journal.exists():
        return
    err.print(f"journal {place.journal}")
    if state.session_file is None or state.file_problem is not None:
        say_next(f"recover {place.journal}")
        return
    err.print(f"session {state.session_file}")
    if state.finished is not None and not state.finished.complete:
        say_next(f"run --session {place.journal}", "goes on at the same point")
    elif app.wish is None:
        say_next(f"review {state.session_file}")


@app.command("run")
@with_controllers
def run_command(
    plan: Annotated[str | None, typer.Argument(help="Plan file or shipped plan.")] = None,
    simulated: Annotated[bool, typer.Option("--sim", help="In the simulated laboratory.")] = False,
    session: Annotated[
        Path, typer.Option(help="Journal to start, or to continue if it exists.")
    ] = Path("session.journal"),
    board: Annotated[
        list[str] | None, typer.Option(help="Port of the board, or a front-end file.")
    ] = None,
    can: Annotated[str, typer.Option(help="slcan port, or interface:channel.")] = "",
    by_hand: ByHand = None,
    mirror: Mirror = None,
    measured_by: MeasuredBy = "",
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    baud: Annotated[int, typer.Option(min=1, help="Bit rate of a UART.")] = 921_600,
    input_range: Annotated[
        float | None,
        typer.Option(help="Largest input voltage of the board; with it sensitivities show in mV."),
    ] = None,
    time_scale: TimeScale = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the simulation's random numbers.")] = 1,
    earlier: Annotated[
        Path | None,
        typer.Option(
            help="Earlier session of the arm: paths measured both ways are compared (reciprocity)."
        ),
    ] = None,
    std: Annotated[
        float | None,
        typer.Option(
            min=0.01,
            help="Standard deviation wanted of the FRF at its strongest resonance, %: the hits "
            "still needed are counted.",
        ),
    ] = None,
    hide: Annotated[
        list[str] | None,
        typer.Option(help="Effect that the simulated arm hides, as payload:faint; repeatable."),
    ] = None,
    *,
    controllers: dict[str, str],
) -> None:
    """Guide the operator through a session, on screens that can be read from two metres.

    Example: armodal run --sim
    """
    port = one_board(board) if board else ""
    check_terminal("run")
    code, then = run_app(
        plan=plan,
        arm=arm,
        session=session,
        mirror=mirror,
        measured_by=measured_by,
        board=port,
        can=can,
        angles=joint_angles(by_hand, can, controllers),
        baud=baud,
        simulated=simulated,
        input_range_v=input_range,
        seed=seed,
        time_scale=time_scale,
        hide=hide or (),
        earlier=earlier,
        std_wanted_percent=std,
    )
    raise typer.Exit(code if then is None else go_from(then))
