"""`armodal sim`: the simulated laboratory on ports of its own."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

from armodal.hil_sim.broken_board import broken_board
from armodal.hil_sim.broken_controller import broken_controller
from armodal.hil_sim.lab import Laboratory, start_laboratory
from armodal.hil_sim.rehearsal import Rehearsal
from armodal.hil_sim.rehearsed_plant import parse_hidden
from armodal.hil_sim.relay import relayed
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan import load_plan
from armodal.tui.command_parts.rehearsed import show_truth, spoken_arm
from armodal.tui.console import Json, TimeScale, out, say, say_next

__all__ = ["app", "broken_lines"]

app = typer.Typer(add_completion=False)


@app.command()
def sim(
    plant: Annotated[
        str | None, typer.Option(help="Shipped plant or a plant file; rv4frl if not given.")
    ] = None,
    arm: Annotated[
        str | None, typer.Option(help="Arm file or shipped arm; true values are drawn and sealed.")
    ] = None,
    plan: Annotated[
        str | None, typer.Option(help="Plan for the arm: it sets the hit levels.")
    ] = None,
    hide: Annotated[
        list[str] | None,
        typer.Option(help="Effect that the arm hides, as payload or payload:faint; repeatable."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random numbers.")] = 1,
    time_scale: TimeScale = 1.0,
    directory: Annotated[
        Path | None, typer.Option("--out", help="Folder for the socket and the ledger.")
    ] = None,
    open_ledger: Annotated[
        Path | None, typer.Option("--open", help="Print the true values of a ledger, and exit.")
    ] = None,
    fault: Annotated[list[str] | None, typer.Option(help="A scripted fault; repeatable.")] = None,
    broken_board: Annotated[
        str | None, typer.Option(help="A board that breaks the protocol in one way.")
    ] = None,
    broken_controller: Annotated[
        str | None, typer.Option(help="A controller or bus with one fault.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Start the simulated laboratory, print its ports, run until Ctrl-C.

    With --arm it simulates that arm: springs, masses, sensors and points differ from the arm file
    as in any real arm, and --hide adds effects. The true values stay sealed until --open.

    Example: armodal sim --arm ur5 --hide payload:faint --seed 3 --out lab
    """
    if open_ledger is not None:
        show_truth(open_ledger, as_json=as_json)
        return
    signal.signal(signal.SIGTERM, _leave)  # the laboratory ends with the command
    with (
        start_laboratory(
            _what(plant, arm, plan, hide),
            seed=seed,
            time_scale=time_scale,
            directory=directory,
            faults=tuple(fault or ()),
        ) as laboratory,
        broken_lines(laboratory, board=broken_board, controller=broken_controller) as lines,
    ):
        ports = {
            "board": lines[0],
            "can": lines[1],
            "operator": str(laboratory.operator),
            "ledger": str(laboratory.ledger),
            "time_scale": laboratory.time_scale,
            "truth_sha256": laboratory.truth_sha256,
        }
        if as_json:
            sys.stdout.write(json.dumps(ports) + "\n")
            sys.stdout.flush()
        else:
            for name, value in ports.items():
                out.print(f"{name:<13}{value}")
        if arm is not None:
            where = laboratory.ledger
            say(f"the truth is sealed; armodal sim --open {where} tells it")
            if directory is None:
                say("without --out the ledger goes when the laboratory ends")
        if not as_json:
            speed = "" if time_scale == 1.0 else f" --time-scale {time_scale:g}"
            of_arm = "" if arm is None else f" --arm {arm}"
            lines_there = f"--board {ports['board']} --can {ports['can']}"
            say_next(f"run {plan or 'PLAN'}{of_arm} {lines_there}{speed}", "in another terminal")
        laboratory.wait()


def _leave(number: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + number)


def _what(
    plant: str | None, arm: str | None, plan: str | None, hide: list[str] | None
) -> str | Rehearsal:
    """Return a plant's name, or an arm with what it hides."""
    if arm is None:
        idle = [n for n, value in (("--plan", plan), ("--hide", hide)) if value]
        if idle:
            raise PlantError(
                f"wanted {' and '.join(idle)} with --arm only, got no arm; name the arm, such as "
                "--arm ur5"
            )
        return plant or "rv4frl"
    if plant is not None:
        raise PlantError(
            "wanted either --plant or --arm, got both; a plant file holds the true values, an "
            "arm file the assumed ones"
        )
    the_arm = load_arm(arm)
    the_plan = None if plan is None else load_plan(plan, the_arm)
    return Rehearsal(arm=spoken_arm(the_arm), plan=the_plan, hidden=parse_hidden(hide or ()))


@contextmanager
def broken_lines(
    laboratory: Laboratory, *, board: str | None, controller: str | None
) -> Iterator[tuple[str, str]]:
    """Put faulty devices in front of a laboratory's; yield the lines of board and adapter.

    Raises
    ------
    PlantError
        If there is no broken device of a name.
    """
    with ExitStack() as keep:
        board_line, can_line = laboratory.board, laboratory.can
        if board is not None:
            board_line = keep.enter_context(relayed(board_line, broken_board(board)))
        if controller is not None:
            can_line = keep.enter_context(relayed(can_line, broken_controller(controller)))
        yield board_line, can_line
