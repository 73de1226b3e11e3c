"""Arguments and options that several commands share, and options refused where they are idle."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from armodal.protocols.errors import ArmError, SessionError

__all__ = ["ArmName", "Seed", "SessionPath", "comma_numbers", "refuse_idle"]

ArmName = Annotated[str, typer.Argument(help="Arm file, or a shipped arm such as rv4frl.")]
SessionPath = Annotated[Path, typer.Argument(help="Session file (.h5).")]
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
