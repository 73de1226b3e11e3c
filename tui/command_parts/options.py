"""Arguments and options that several commands share, and options refused where they are idle."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Annotated

import numpy as np
import platformdirs
import typer

from armodal.daq.journal_mirror import on_one_disk
from armodal.protocols.errors import ArmError, SessionError
from armodal.tui.console import say

__all__ = [
    "ArmName",
    "Band",
    "ByHand",
    "MeasuredBy",
    "Minutes",
    "Mirror",
    "Seed",
    "SessionPath",
    "comma_numbers",
    "one_board",
    "refuse_idle",
    "say_if_on_one_disk",
    "sensor_memory",
]

ArmName = Annotated[str, typer.Argument(help="Arm file, or a shipped arm such as rv4frl.")]
SessionPath = Annotated[Path, typer.Argument(help="Session file (.h5).")]
Band = Annotated[
    tuple[float, float] | None,
    typer.Option(help="Only lines from LOW to HIGH Hz."),
]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the random numbers.")]
Minutes = Annotated[
    float | None,
    typer.Option(min=1.0, help="Longest duration, min: fewer points, every link still observed."),
]
ByHand = Annotated[
    float | None,
    typer.Option(
        metavar="DEG",
        help="Without a bus: you type or confirm the joint angles, true to so many degrees.",
    ),
]
MeasuredBy = Annotated[str, typer.Option(metavar="NAME", help="Who measures; the report says so.")]
Mirror = Annotated[
    Path | None,
    typer.Option(help="Folder on another disk: the journal is kept there too, hit by hit."),
]


def say_if_on_one_disk(journal: Path, mirror: Path | None) -> None:
    """Tell who asks for a mirror that it lies on the journal's own disk."""
    if mirror is not None and on_one_disk(journal, mirror):
        say(f"--mirror {mirror} is on the journal's own disk: it does not help where that fails")


def one_board(ports: list[str]) -> str:
    """The one board of a session.

    Raises
    ------
    SessionError
        If there are several: their samples are of clocks of their own.
    """
    if len(ports) > 1:
        raise SessionError(
            f"wanted one --board, got {', '.join(ports)}: two boards sample by two clocks, and a "
            "session has one; connect all sensors to one board, or measure one after the other"
        )
    return ports[0]


def sensor_memory() -> Path:
    """Where the sensitivities that sensors were last used with are remembered."""
    return platformdirs.user_data_path("armodal") / "sensors.json"


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


def refuse_idle(context: typer.Context, idle: Collection[str], *, here: str, there: str) -> None:
    """Refuse what was given although it has no effect here; defaults pass.

    Parameters
    ----------
    idle
        Names of the command's parameters.
    here, there
        What the command was called with, and what these options belong to.

    Raises
    ------
    SessionError
        If one was given; all are named as the user wrote them.
    """
    given = []
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name or "")
        if parameter.name in idle and source is not None and source.name != "DEFAULT":
            given.append(parameter.opts[0])
    if given:
        raise SessionError(
            f"wanted {', '.join(given)} with {there} only, got {here}; leave "
            f"{'it' if len(given) == 1 else 'them'} out, or give {there} in place of {here}"
        )
