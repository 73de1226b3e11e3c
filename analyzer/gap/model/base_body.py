"""The body of the base: what stands on the bolts has a mass, and moves where they give way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import BASE, Assembly, spatial_inertia
from armodal.analyzer.gap.model.geometry import skew
from armodal.analyzer.gap.model.priors import (
    BASE_ASIDE_STD,
    BASE_DISC,
    BASE_FARTHEST_M,
    BASE_HEIGHT_M,
    BASE_HEIGHT_STD_M,
    BASE_MASS,
    BASE_MASS_MOST,
    BASE_MASS_STD,
    BASE_RADIUS,
    BASE_RADIUS_MOST,
    BASE_RADIUS_STD,
)
from armodal.analyzer.gap.model.scales import foot_m
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["BASE_BODY", "BASE_MASS_NAME", "add_base_body", "base_body_parameters"]

Array = npt.NDArray[np.float64]

BASE_MASS_NAME, _HEIGHT, _RADIUS = "base mass", "base height", "base radius"
_ASIDE = ("base aside x", "base aside y")
BASE_BODY = (BASE_MASS_NAME, _HEIGHT, _RADIUS, *_ASIDE)
_DISC = np.diag(BASE_DISC)


def base_body_parameters(superset: Superset, plate_m: float) -> Iterator[Parameter]:
    """Mass, centre and radius of gyration; `plate_m` is the radius of what stands on the bolts."""
    total = sum(joint.link.mass_kg for joint in superset.arm.joints)
    yield _part_of(BASE_MASS_NAME, "kg", total, (BASE_MASS, BASE_MASS_STD, BASE_MASS_MOST))
    yield Parameter(
        name=_HEIGHT,
        unit="m",
        mean=BASE_HEIGHT_M,
        std=BASE_HEIGHT_STD_M,
        low=-BASE_FARTHEST_M,
        high=BASE_FARTHEST_M,
    )
    radius = (BASE_RADIUS, BASE_RADIUS_STD, BASE_RADIUS_MOST)
    yield _part_of(_RADIUS, "m", plate_m, radius, untold=plate_m)
    for name in _ASIDE:
        yield Parameter(name=name, unit="m", mean=0.0, std=BASE_ASIDE_STD * plate_m, untold=0.0)


def add_base_body(assembly: Assembly, superset: Superset, values: Mapping[str, float]) -> None:
    """Add it where the arm stands; its derivatives are known."""
    center = foot_m(superset) + [values[name] for name in (*_ASIDE, _HEIGHT)]
    here, slopes = _inertia(values[BASE_MASS_NAME], center, values[_RADIUS])
    assembly.base_inertia = assembly.base_inertia + here
    for name, slope in zip((BASE_MASS_NAME, *_ASIDE, _HEIGHT, _RADIUS), slopes, strict=True):
        assembly.inertia_of[name] = BASE, slope


def _part_of(
    name: str,
    unit: str,
    whole: float,
    parts: tuple[float, float, float],
    untold: float | None = None,
) -> Parameter:
    """What is no less than nothing, by its mean, deviation and most as parts of a whole."""
    mean, std, most = (whole * part for part in parts)
    return Parameter(name=name, unit=unit, mean=mean, std=std, low=0.0, high=most, untold=untold)


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
