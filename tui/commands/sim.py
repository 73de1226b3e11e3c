"""`armodal sim`: the simulated laboratory on ports of its own."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated

import typer

from armodal.hil_sim.broken_board import broken_board
from armodal.hil_sim.broken_controller import broken_controller
from armodal.hil_sim.lab import Laboratory, start_laboratory
from armodal.hil_sim.relay import relayed
from armodal.tui.console import Json, TimeScale, out

__all__ = ["app", "broken_lines"]

app = typer.Typer(add_completion=False)


@app.command()
def sim(
    plant: Annotated[str, typer.Option(help="Shipped plant or a plant file.")] = "rv4frl",
    seed: Annotated[int, typer.Option(min=0, help="For everything random in it.")] = 1,
    time_scale: TimeScale = 1.0,
    directory: Annotated[Path | None, typer.Option("--out", help="Socket and ledger.")] = None,
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

    Example: armodal sim --time-scale 8
    """
    with (
        start_laboratory(
            plant, seed=seed, time_scale=time_scale, directory=directory, faults=tuple(fault or ())
        ) as laboratory,
        broken_lines(laboratory, board=broken_board, controller=broken_controller) as lines,
    ):
        ports = {
            "board": lines[0],
            "can": lines[1],
            "operator": str(laboratory.operator),
            "ledger": str(laboratory.ledger),
            "time_scale": laboratory.time_scale,
        }
        if as_json:
            sys.stdout.write(json.dumps(ports) + "\n")
            sys.stdout.flush()
        else:
            for name, value in ports.items():
                out.print(f"{name:<11}{value}")
        laboratory.wait()


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
