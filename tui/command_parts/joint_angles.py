"""Where joint angles come from: an option for every controller, the bus, or a person."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import wraps
from typing import Annotated, Any

import typer

from armodal.daq.controller import Controller, controller_options
from armodal.protocols.errors import SessionError

__all__ = ["JointAngles", "joint_angles", "with_controllers"]

MOST_TOLD_DEG = 10.0  # an angle read less closely than this says nothing of a posture


@dataclass(frozen=True, slots=True, kw_only=True)
class JointAngles:
    """Where they come from; with neither, from the bus.

    controller : in place of the bus
    told_rad : a person reads them, to so much
    """

    controller: Controller | None = None
    told_rad: float | None = None


def with_controllers(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command an option for every controller found; it takes `controllers`, by name."""
    signature = inspect.signature(command, eval_str=True)
    own = [each for each in signature.parameters.values() if each.name != "controllers"]
    options = {
        name: inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default="",
            annotation=Annotated[
                str, typer.Option(metavar=option.metavar, help=f"Without a bus: {option.help}")
            ],
        )
        for name, option in controller_options().items()
    }

    @wraps(command)
    def with_them(**given: Any) -> None:
        controllers = {name: given.pop(name) for name in options}
        command(**given, controllers=controllers)

    with_them.__signature__ = signature.replace(  # type: ignore[attr-defined]  # read by inspect
        parameters=[each.replace(kind=inspect.Parameter.KEYWORD_ONLY) for each in own]
        + list(options.values())
    )
    return with_them


def joint_angles(by_hand: float | None, can: str, controllers: Mapping[str, str]) -> JointAngles:
    """Return where joint angles come from.

    Raises
    ------
    SessionError
        If there is more than one source of joint angles, or the tolerance of a person is none.
    ArmodalError
        If a controller cannot be meant.
    """
    person = None if by_hand is None else f"{by_hand:g}"
    given = {"can": can, **controllers, "by-hand": person}
    named = [f"--{option} {value}" for option, value in given.items() if value]
    if len(named) > 1:
        raise SessionError(
            f"wanted joint angles from one source, got {', '.join(named)}: they are never mixed in "
            "a session; leave all but one out"
        )
    for name, value in controllers.items():
        if value:
            return JointAngles(controller=controller_options()[name].controller(value))
    if by_hand is None:
        return JointAngles()
    if not 0.0 < by_hand <= MOST_TOLD_DEG:
        raise SessionError(
            f"--by-hand: wanted degrees above 0 and at most {MOST_TOLD_DEG:g}, got {by_hand:g}; "
            "say to how much you can read a joint's angle"
        )
    return JointAngles(told_rad=math.radians(by_hand))
