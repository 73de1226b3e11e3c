"""A base that rocks and shifts on its floor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.model.assembly import BASE, Assembly, spatial_inertia
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import skew
from armodal.analyzer.gap.model.interface import loss_factor_parameter
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.soft_parts import BASE_TURN, BASE_WAYS
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="base",
    title="Base rocks or shifts on its floor",
    changes="releases the six motions of the base on springs; adds the base's own mass",
    signature="points on the base move with the arm, more in postures that reach far",
    confused_with=("bearing", "link_axis"),
    told_by="a sensor on the base plate and one on the floor beside it",
    remedy="retorque the base bolts, grout or shim the plate, or test on a stiffer foundation",
)
_START = 0.05  # likewise of rocking: from nothing a fit finds its way slowly
_FARTHEST_M = 0.3  # a base's centre and pivot from the arm's origin
# A pedestal up to the height of two hands, on bolts in its foot. No source: assumed.
_HEIGHT_M, _HEIGHT_STD_M, _PIVOT_STD_M = 0.1, 0.1, 0.1
# Of the moving mass. Pedestals weigh from a tenth of the arm to as much. No source: assumed.
_MASS, _MASS_STD, _MASS_MOST = 0.3, 0.3, 2.0
# Radii of gyration of a disc over its radius, squared.
_DISC = np.diag([0.25, 0.25, 0.5])
# Of that disc, over the plate's on its bolts: a foot as wide as the first link to the plate itself.
_RADIUS, _RADIUS_STD, _RADIUS_MOST = 0.5, 0.45, 2.0
_ASIDE_STD = 0.1  # its centre from the first joint's axis, over the plate's radius
_UP = skew(np.array([0.0, 0.0, 1.0]))


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """The one base."""
    names = [f"base {way}" for way in BASE_WAYS]
    mass, height, pivot, turn = "base mass", "base height", "base pivot", BASE_TURN.name
    radius, factor = "base radius", "base loss factor"
    aside = ["base aside x", "base aside y"]
    plate_m = float(np.sqrt(2.0)) * ordinary.base_lever_m  # the lever is radius over root 2

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        c, s = np.cos(values[turn]), np.sin(values[turn])
        rocking = np.zeros((2, ordinary.superset.n))  # about lines through the pivot
        lower = np.zeros((2, ordinary.superset.n))
        rocking[:, 3:5], lower[:, :3] = np.eye(2), _UP[:, :2].T
        rocking += values[pivot] * lower
        turned, across = np.array([[c, s], [-s, c]]), np.array([[-s, c], [-c, -s]])
        at = [assembly.names[name] for name in names[3:5]]
        for i, column in zip(at, turned @ rocking, strict=True):
            assembly.columns[i] = column
        assembly.motion_of[pivot] = list(zip(at, turned @ lower, strict=True))
        assembly.motion_of[turn] = list(zip(at, across @ rocking, strict=True))
        center = np.array([values[name] for name in (*aside, height)])
        here, slopes = _inertia(values[mass], center, values[radius])
        assembly.base_inertia = assembly.base_inertia + here
        for name, slope in zip((mass, *aside, height, radius), slopes, strict=True):
            assembly.inertia_of[name] = BASE, slope

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        """Level lines in the base's frame that it rocks about."""
        c, s = float(np.cos(values[turn])), float(np.sin(values[turn]))
        return {"rock_x_about": [c, s, 0.0], "rock_y_about": [-s, c, 0.0]}

    rock = compliance_parameter("", ordinary, 0)
    relaxes = {
        name: Parameter(
            name=name,
            unit="rad/(N m)" if i >= 3 else "m/N",
            mean=0.0,
            low=0.0,
            std=rock.std * (1.0 if i >= 3 else ordinary.base_lever_m**2),
            start=_START * ordinary.compliance if name in names[3:5] else None,
        )
        for i, name in enumerate(names)
    }
    total = sum(joint.link.mass_kg for joint in ordinary.arm.joints)
    return (
        Instance(
            effect=WORDS,
            place="base",
            parameters=(
                _part_of(mass, "kg", total, (_MASS, _MASS_STD, _MASS_MOST)),
                _at_height(height, _HEIGHT_M, _HEIGHT_STD_M),
                _at_height(pivot, 0.0, _PIVOT_STD_M),
                replace(
                    _part_of(radius, "m", plate_m, (_RADIUS, _RADIUS_STD, _RADIUS_MOST)),
                    untold=plate_m,
                ),
                *(
                    Parameter(name=name, unit="m", mean=0.0, std=_ASIDE_STD * plate_m, untold=0.0)
                    for name in aside
                ),
            ),
            # As they were, but told.
            relaxes=relaxes | {turn: BASE_TURN, factor: loss_factor_parameter(factor)},
            builder=build,
            describe=describe,
            details=(radius, *aside),
            size=names[3],
            sizes=tuple(names[3:6]),
            side_sizes=tuple(
                (name, ordinary.floor_limit * ordinary.base_lever_m**2) for name in names[:3]
            ),
            material=ordinary.floor_limit,
        ),
    )


def _part_of(name: str, unit: str, whole: float, parts: tuple[float, float, float]) -> Parameter:
    """What is no less than nothing, by its mean, deviation and most as parts of a whole."""
    mean, std, most = (whole * part for part in parts)
    return Parameter(name=name, unit=unit, mean=mean, std=std, low=0.0, high=most)


def _at_height(name: str, mean_m: float, std_m: float) -> Parameter:
    return Parameter(
        name=name, unit="m", mean=mean_m, std=std_m, low=-_FARTHEST_M, high=_FARTHEST_M
    )


def _inertia(mass_kg: float, center_m: Array, radius_m: float) -> tuple[Array, tuple[Array, ...]]:
    """The base's own (6, 6), and its slopes by mass, each part of its centre, and radius."""
    of_one = spatial_inertia(1.0, center_m, radius_m**2 * _DISC)
    by_radius = np.zeros((6, 6))
    by_radius[3:, 3:] = 2.0 * radius_m * _DISC
    by_center = []
    for unit in np.eye(3):
        slope, moved = np.zeros((6, 6)), skew(unit)
        slope[:3, 3:], slope[3:, :3] = -moved, moved
        slope[3:, 3:] = -moved @ skew(center_m) - skew(center_m) @ moved
        by_center.append(mass_kg * slope)
    return mass_kg * of_one, (of_one, *by_center, mass_kg * by_radius)
