"""What of an arm gives way a little beside its drives: bearings, long links, the base on its bolts.

No part is rigid, and descriptions of arms say nothing of these. Each is a compliance with a prior
far below its drive's, up to a limit beyond which it is an effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache, partial

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.interface import loss_factor_parameter, loss_parameter
from armodal.analyzer.gap.model.long_links import LongLink, long_links
from armodal.analyzer.gap.model.priors import (
    BASE_LEVER,
    BEARING_LEVER,
    BEARING_LIMIT,
    BEARING_MEAN,
    BEARING_STD,
    BEND_LIMIT,
    BEND_MEAN,
    BEND_PLACE,
    BEND_PLACE_LEAST,
    BEND_PLACE_MOST,
    BEND_PLACE_STD,
    BEND_STD,
    FLOOR_LIMIT,
    FLOOR_MEAN,
    FLOOR_STD,
    LEAN_STD,
    MASS_SPREAD,
    NEAR_M,
    SHIFT_STDS,
    TURN_MOST,
    TURN_STD,
)
from armodal.analyzer.gap.model.scales import compliance, doubt, foot_m, reach_m, scale
from armodal.analyzer.gap.model.space import Parameter
from armodal.protocols.arrays import frozen_array

__all__ = [
    "BASE_TURN",
    "BASE_WAYS",
    "add_soft_parts",
    "base_lever_m",
    "place_parameter",
    "soft_part_parameters",
]

Array = npt.NDArray[np.float64]

BASE_WAYS = ("shift x", "shift y", "shift z", "rock x", "rock y", "rock z")
# About which level line it is softest.
BASE_TURN = Parameter(
    name="base turn", unit="rad", mean=0.0, std=TURN_STD, low=-TURN_MOST, high=TURN_MOST
)
_BEND_WAYS = ("a", "b", "along")
_Bend = tuple[LongLink, Array, tuple[Array, Array]]  # motions (2, 3, N), pieces


def base_lever_m(superset: Superset) -> float:
    """Return the root of how much a base shifts over how much it rocks under unit loads."""
    return BASE_LEVER * reach_m(superset)


def soft_part_parameters(superset: Superset) -> Iterator[Parameter]:
    """Every compliance with its prior; their losses; where bearings stand along their axes."""
    yield from _of_base(superset)
    for joint in range(len(superset.arm.joints)):
        yield from _of_bearing(superset, joint)
    for line, _, _ in _bends(superset):
        yield place_parameter(f"bend place {line.name}")
        unit = scale(superset, line.link)
        for way in _BEND_WAYS:
            yield _small(f"bend {way} {line.name}", unit, BEND_MEAN, BEND_STD, BEND_LIMIT)
        yield Parameter(name=f"bend lean {line.name}", unit="", mean=0.0, std=LEAN_STD)
        yield from _losses("bend loss", line.name)


def place_parameter(name: str) -> Parameter:
    """Return where along its line a link gives way, a part of its length; untold, its middle."""
    return Parameter(
        name=name,
        unit="",
        mean=BEND_PLACE,
        std=BEND_PLACE_STD,
        low=BEND_PLACE_LEAST,
        high=BEND_PLACE_MOST,
        untold=BEND_PLACE,
    )


def add_soft_parts(assembly: Assembly, superset: Superset, values: Mapping[str, float]) -> None:
    """Add the coordinates that give way, at these values of the parameters."""
    add = partial(_add, assembly, values)
    for number, joint in enumerate(superset.arm.joints):
        losses = _loss_names("bearing loss", joint.name)
        for name, column in _bearing(superset, number):
            add(name, column, losses)
        place = f"bearing place {joint.name}"
        for side, (tilt, moved) in zip("ab", _tilts(superset)[number], strict=True):
            at = add(f"bearing {side} {joint.name}", tilt + values[place] * moved, losses)
            assembly.motion_of.setdefault(place, []).append((at, moved))
    for bend in _bends(superset):
        _add_bend(assembly, superset, values, bend)
    c, s = np.cos(values[BASE_TURN.name]), np.sin(values[BASE_TURN.name])
    units = {way: assembly.unit(i) for i, way in enumerate(BASE_WAYS)}
    for axis, way in zip(np.eye(3), BASE_WAYS[3:], strict=True):  # about the arm's foot
        units[way][:3] += np.cross(foot_m(superset), axis)
    x, y = units["rock x"], units["rock y"]
    turned = {"rock x": c * x + s * y, "rock y": c * y - s * x}
    at_of = {
        way: add(f"base {way}", column, _loss_names("base loss"))
        for way, column in (units | turned).items()
    }
    assembly.motion_of[BASE_TURN.name] = [
        (at_of["rock x"], turned["rock y"]),
        (at_of["rock y"], -turned["rock x"]),
    ]


def _add(
    assembly: Assembly,
    values: Mapping[str, float],
    name: str,
    column: Array,
    losses: tuple[str, str],
) -> int:
    """Add what gives way by a parameter along a motion; its coordinate."""
    loss, factor = losses
    at = assembly.add_compliance(column, values[name], values[loss], name, loss)
    assembly.add_loss_factor([at], values[factor], factor)
    return at


def _add_bend(
    assembly: Assembly, superset: Superset, values: Mapping[str, float], bend: _Bend
) -> None:
    """Add a long link's hinge where it gives way, which moves what lies beyond."""
    line, (turns, moved), pieces = bend
    by = f"bend place {line.name}"
    place = min(max(values[by], BEND_PLACE_LEAST), BEND_PLACE_MOST)
    columns = turns + (place - BEND_PLACE) * moved
    inside = line.about(superset, place, by)
    losses = _loss_names("bend loss", line.name)
    lean = f"bend lean {line.name}"
    assembly.ordinary_pieces[line.link] = pieces
    for way, column, change in zip(_BEND_WAYS, columns, moved, strict=True):
        leans = values[lean] if way == "b" else 0.0  # as `effects.yielding_line` has it
        at = _add(assembly, values, f"bend {way} {line.name}", column + leans * columns[0], losses)
        assembly.inside[at] = inside
        assembly.motion_of.setdefault(by, []).append((at, change + leans * moved[0]))
        if way == "b":
            assembly.motion_of[lean] = [(at, columns[0])]


def _of_base(superset: Superset) -> Iterator[Parameter]:
    rocks = compliance(superset)
    shifts = rocks * base_lever_m(superset) ** 2
    for way in BASE_WAYS:
        unit, of = (shifts, "m/N") if way.startswith("shift") else (rocks, "rad/(N m)")
        yield _small(f"base {way}", unit, FLOOR_MEAN, FLOOR_STD, FLOOR_LIMIT, unit=of)
    yield BASE_TURN
    yield from _losses("base loss")


def _of_bearing(superset: Superset, number: int) -> Iterator[Parameter]:
    joint, tilts = superset.arm.joints[number], scale(superset, number)
    times = doubt(superset, number)
    std, limit = times * BEARING_STD, times * BEARING_LIMIT
    for side in "ab":
        yield _small(f"bearing {side} {joint.name}", tilts, BEARING_MEAN, std, limit)
    yield from _losses("bearing loss", joint.name)
    std_m = NEAR_M + 0.5 * _reach_along(superset, number)
    yield Parameter(name=f"bearing place {joint.name}", unit="m", mean=0.0, std=std_m)
    shifts = tilts * (BEARING_LEVER * reach_m(superset)) ** 2
    for way in ("radial", "axial"):
        name = f"bearing {way} {joint.name}"
        yield _small(name, shifts, BEARING_MEAN, SHIFT_STDS * std, np.inf, unit="m/N")
    if joint.stiffness is None:
        yield _small(f"compliance of {joint.name}", tilts, BEARING_MEAN, std, limit)


def _small(
    name: str, of: float, mean: float, std: float, limit: float, *, unit: str = "rad/(N m)"
) -> Parameter:
    """A compliance as a part `of` another."""
    return Parameter(name=name, unit=unit, mean=mean * of, std=std * of, low=0.0, high=limit * of)


def _losses(loss: str, where: str = "") -> Iterator[Parameter]:
    """Both of them."""
    grows, factor = _loss_names(loss, where)
    yield loss_parameter(grows)
    yield loss_factor_parameter(factor)


def _loss_names(loss: str, where: str = "") -> tuple[str, str]:
    """Of a loss that grows with frequency, and of one that does not."""
    return f"{loss} {where}".rstrip(), f"{loss} factor {where}".rstrip()


def _reach_along(superset: Superset, number: int) -> float:
    """How far the joints before and behind are along a joint's axis.

    Frames of joints stand where axes cross, and a bearing anywhere along its own.
    """
    joints = superset.arm.joints
    axis = np.asarray(joints[number].axis)
    T = joints[number].T_parent_joint
    back = abs(float(T[:3, :3] @ axis @ T[:3, 3]))
    if number + 1 == len(joints):
        return back
    return back + abs(float(axis @ joints[number + 1].T_parent_joint[:3, 3]))


def _bearing(superset: Superset, number: int) -> Iterator[tuple[str, Array]]:
    """What gives way in a joint without turning across its axis."""
    joint = superset.arm.joints[number]
    across_it, along = _shifts(superset, number)
    for column in across_it:
        yield f"bearing radial {joint.name}", column
    yield f"bearing axial {joint.name}", along
    if joint.stiffness is None:
        column = np.zeros(superset.n)
        column[superset.joint_column(number)] = 1.0
        yield f"compliance of {joint.name}", column


@lru_cache(maxsize=16)
def _tilts(superset: Superset) -> Array:
    """(n_joints, 2, 2, N) motion by each joint's two tilts, and its change by their place.

    A tilt about a point at z along the axis shifts the joint's origin by z axis x tilt.
    """
    found = np.zeros((len(superset.arm.joints), 2, 2, superset.n))
    for i, joint in enumerate(superset.arm.joints):
        axis, columns = np.asarray(joint.axis), superset.interface_columns(i)
        tilts = across(axis).T
        found[i, :, 0, columns][:, 3:] = tilts
        found[i, :, 1, columns][:, :3] = np.cross(axis, tilts)
    return frozen_array(found, np.float64)


@lru_cache(maxsize=64)
def _shifts(superset: Superset, number: int) -> tuple[Array, Array]:
    """(2, N) motion by a joint's shifts across its axis, and (N,) along it."""
    axis = np.asarray(superset.arm.joints[number].axis)
    found = np.zeros((3, superset.n))
    found[:, superset.interface_columns(number)][:, :3] = [*across(axis).T, axis]
    found = frozen_array(found, np.float64)
    return found[:2], found[2]


@lru_cache(maxsize=16)
def _bends(superset: Superset) -> tuple[_Bend, ...]:
    """Long links, motion by each one's hinge at half its length and its change, their pieces.

    With what gives way at both of its ends that is Simpson's rule over the link's length.
    """
    found = []
    for line in long_links(superset):
        middle = line.start_m + BEND_PLACE * line.length_m * line.along
        turns = np.array([*across(line.along).T, line.along])
        columns = np.zeros((2, 3, superset.n))
        own = columns[..., superset.interface_columns(line.link)]  # a view
        own[0] = np.hstack([np.cross(middle, turns), turns])
        own[1, :, :3] = np.cross(line.length_m * line.along, turns)
        pieces = line.pieces(superset.arm.joints[line.link].link, MASS_SPREAD)
        found.append((line, frozen_array(columns, np.float64), pieces))
    return tuple(found)
