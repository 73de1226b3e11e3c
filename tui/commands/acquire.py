"""`armodal acquire` and `armodal recover`: into a journal, and out of it."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from armodal import SOFTWARE
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.daq.controller import without_bus_options
from armodal.daq.events import Event
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmodalError, DeviceLostError, SessionError
from armodal.protocols.plan import load_plan
from armodal.protocols.session.recovery import rebuild
from armodal.tui.command_parts.joint_angles import JointAngles, joint_angles, with_controllers
from armodal.tui.command_parts.options import (
    ByHand,
    MeasuredBy,
    Mirror,
    one_board,
    say_if_on_one_disk,
    sensor_memory,
)
from armodal.tui.command_parts.rehearsed import spoken_arm
from armodal.tui.console import Json, TimeScale, err, out, print_json, say_next
from armodal.tui.operators import Operator, PersonAtTerminal, ScriptedOperator, acquire, describe

__all__ = ["app", "show_event"]

app = typer.Typer(add_completion=False)


def show_event(event: Event) -> None:
    """Print what an acquisition tells a person."""
    line = describe(event)
    if line is not None:
        err.print(line)


@app.command("acquire")
@with_controllers
def acquire_command(
    plan: Annotated[str, typer.Argument(help="Plan file or shipped plan.")],
    board: Annotated[list[str], typer.Option(help="Port of the board, or a front-end file.")],
    can: Annotated[str, typer.Option(help="slcan port, or interface:channel.")] = "",
    by_hand: ByHand = None,
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    journal: Annotated[Path, typer.Option(help="Journal to write.")] = Path("session.journal"),
    resume: Annotated[bool, typer.Option(help="Continue an interrupted journal.")] = False,
    mirror: Mirror = None,
    measured_by: MeasuredBy = "",
    operator: Annotated[Path | None, typer.Option(help="Socket of a scripted operator.")] = None,
    time_scale: TimeScale = 1.0,
    baud: Annotated[int, typer.Option(min=1, help="Bit rate of a UART.")] = 921_600,
    accept_teds: Annotated[
        bool,
        typer.Option(
            help="Measure even if the sensors' TEDS differ from the board's settings or from "
            "an earlier sensitivity; this is recorded."
        ),
    ] = False,
    as_json: Json = False,
    *,
    controllers: dict[str, str],
) -> None:
    """Capture a session: postures, points and hits of a plan, into a durable journal.

    Joint angles come from the controller's bus; with --ur from a Universal Robots controller by
    RTDE; with --mqtt from a broker; with --by-hand from you: you confirm or type them at every
    posture, and results say so.

    Example: armodal acquire rv4frl-three-postures --board /dev/ttyACM0 --can /dev/ttyACM1
    """
    the_arm = load_arm(arm)
    if operator is not None and can and not resume:
        the_arm = spoken_arm(the_arm)
    the_plan = load_plan(plan, the_arm)
    angles = joint_angles(by_hand, can, controllers)
    if not can and angles == JointAngles():
        raise SessionError(
            "wanted where joint angles come from, got nothing: give --can with the port of the "
            f"controller's bus, {without_bus_options()}"
        )
    settings = AcquisitionSettings(
        board_port=one_board(board),
        board_baud=baud,
        can_channel=can,
        controller=angles.controller,
        told_tolerance_rad=angles.told_rad,
        arm=the_arm,
        plan=the_plan,
        journal=journal,
        mirror=mirror,
        measured_by=measured_by,
        resume=resume,
        teds_confirmed=accept_teds,
        sensor_memory=None if operator is not None else sensor_memory(),
        time_scale=time_scale,
        software=SOFTWARE,
    )
    say_if_on_one_disk(journal, mirror)
    with ExitStack() as keep:
        person: Operator = PersonAtTerminal(err.input, told_rad=angles.told_rad)
        if operator is not None:
            script = ScriptedOperator(
                operator,
                the_arm,
                the_plan,
                time_scale=time_scale,
                tells_posture=angles.told_rad is not None,
            )
            keep.callback(script.close)
            person = script
        try:
            finished = acquire(settings, person, show_event)
        except ArmodalError as error:
            if not isinstance(person, ScriptedOperator) or person.listens:
                raise
            raise DeviceLostError(
                f"the simulated laboratory of {operator} has ended; armodal sim says why where it "
                f"ran. Accepted hits are in {journal}: start it again, and go on with --resume"
            ) from error
    session_path = journal.with_suffix(".h5")
    superset = Superset(the_arm)
    rebuild(
        journal,
        session_path,
        software=SOFTWARE,
        estimate_frfs=lambda session: estimate_frfs(session, superset),
    )
    summary = {
        "session": str(session_path),
        "journal": str(journal),
        "complete": finished.complete,
        "reason": finished.reason,
        "hits": {"accepted": finished.accepted, "rejected": finished.rejected},
    }
    if as_json:
        print_json(summary)
    else:
        out.print(
            f"{finished.accepted} hits accepted, {finished.rejected} rejected: "
            f"{finished.reason}\nsession {session_path}"
        )
        say_next(f"review {session_path}" if finished.complete else f"acquire --resume {journal}")
