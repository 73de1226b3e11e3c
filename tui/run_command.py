"""`armodal run`: the operator's app."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from armodal.tui.console import TimeScale
from armodal.tui.run.command import run_app
from armodal.tui.software import SOFTWARE

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command("run")
def run_command(
    plan: Annotated[str | None, typer.Argument(help="Plan file or shipped plan.")] = None,
    simulated: Annotated[bool, typer.Option("--sim", help="In the simulated laboratory.")] = False,
    session: Annotated[
        Path, typer.Option(help="Journal to begin, or to go on with if it is there.")
    ] = Path("session.journal"),
    board: Annotated[str, typer.Option(help="Serial port of the acquisition board.")] = "",
    can: Annotated[str, typer.Option(help="slcan port, or interface:channel.")] = "",
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    baud: Annotated[int, typer.Option(min=1, help="Bit rate of a UART.")] = 921_600,
    input_range: Annotated[
        float | None,
        typer.Option(help="Largest input voltage of the board; with it sensitivities show in mV."),
    ] = None,
    time_scale: TimeScale = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="For everything random in the simulation.")] = 1,
) -> None:
    """Guide the operator through a session, on screens that read from two metres.

    Example: armodal run --sim
    """
    raise typer.Exit(
        run_app(
            plan=plan,
            arm=arm,
            session=session,
            board=board,
            can=can,
            baud=baud,
            simulated=simulated,
            input_range_v=input_range,
            seed=seed,
            time_scale=time_scale,
            software=SOFTWARE,
        )
    )
