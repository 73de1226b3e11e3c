"""Arguments and options that several commands share, and options refused where they are idle."""

from __future__ import annotations

import math
from collections.abc import Collection
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from armodal.protocols.errors import ArmError, SessionError

__all__ = [
    "ArmName",
    "Band",
    "ByHand",
    "Seed",
    "SessionPath",
    "comma_numbers",
    "refuse_idle",
    "told_tolerance_rad",
]

MOST_TOLD_DEG = 10.0  # an angle read less closely than this says nothing of a posture

ArmName = Annotated[str, typer.Argument(help="Arm file, or a shipped arm such as rv4frl.")]
SessionPath = Annotated[Path, typer.Argument(help="Session file (.h5).")]
Band = Annotated[
    tuple[float, float] | None,
    typer.Option(help="Only lines from LOW to HIGH Hz."),
]
Seed = Annotated[int, typer.Option(min=0, help="For everything random.")]
ByHand = Annotated[
    float | None,
    typer.Option(
        metavar="DEG", help="No bus: you read the joint angles yourself, to so many degrees."
    ),
]


def told_tolerance_rad(by_hand: float | None, can: str) -> float | None:
    """The tolerance of angles told by hand, rad; None where the bus tells them.

    Raises
    ------
    SessionError
        If there is a bus as well, or the tolerance is none.
    """
    if by_hand is None:
        return None
    if can:
        raise SessionError(
            f"wanted either --can or --by-hand, got both ({can}, {by_hand:g}): measured and told "
            "angles are never mixed; leave one out"
        )
    if not 0.0 < by_hand <= MOST_TOLD_DEG:
        raise SessionError(
            f"--by-hand: wanted degrees above 0 and at most {MOST_TOLD_DEG:g}, got {by_hand:g}; "
            "say to how much you can read a joint's angle"
        )
    return math.radians(by_hand)


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
