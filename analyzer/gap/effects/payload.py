"""Something bolted to a link that nobody told the model of."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.shared_axis import is_on_shared_axis
from armodal.analyzer.gap.model.assembly import Assembly, spatial_inertia
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import skew
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.scales import reach_m
from armodal.analyzer.gap.model.space import Parameter
from armodal.protocols.arrays import frozen_array

__all__ = ["WORDS", "instances"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="payload",
    title="Unmodelled mass on a link",
    changes="mass, first moments and inertia of a rigid body on a link",
    signature="frequencies fall together with the share that the link has in each mode",
    confused_with=("rotor", "hammer_gain"),
    told_by="a known mass added at the same place",
    remedy="weigh what the link carries: tool, valves, cables; the new arm file has it",
)
_MATERIAL_KG, _MATERIAL = 0.2, 0.003  # or of the arm's mass, whichever is less
_START = 0.02  # of the arm's mass: from nothing a fit may end with moments of no mass
_STD = 0.1  # of the arm's mass
# Lengths are parts of the arm's, from joint to joint: a large arm carries large tools.
_LEVER_STD, _FURTHEST = 0.12, 0.4  # of its centre from the link's: of the moment, and at most
_LEAST_KG = 0.02
_STEP = 1e-6  # kg and kg m, for slopes
# Of gyration: from a compact tool flange to a spread gripper with hoses. No source: assumed.
_RADIUS, _RADIUS_STD, _LARGEST = 0.065, 0.055, 0.27
# Elements of its inertia beyond that of a ball, over m r^2. From rods (-1, 1/2, 1/2 about its axes)
# to plates (1/2, -1/4, -1/4), turned anyhow: ten times their variance is the sum of those squares.
_UNEVEN = ("xx", "yy", "xy", "xz", "yz")  # and zz such that their sum is nothing
_UNEVEN_STD, _UNEVEN_MOST = 0.29, 0.5


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each link from the third on: what hangs on the others changes little."""
    last = len(ordinary.arm.joints) - 1
    return tuple(_on(ordinary, link) for link in range(min(2, last), last + 1))


def _on(ordinary: Ordinary, link: int) -> Instance:
    """Mass and first moment about the link's centre: but for a small part the equations are linear.

    A place for its own would be lost at a small mass.
    """
    joint = ordinary.arm.joints[link]
    name, center = joint.link.name, joint.link.center_m
    length_m = reach_m(ordinary.superset)
    total = sum(j.link.mass_kg for j in ordinary.arm.joints)
    mass = f"payload {name}"
    moments = [f"payload moment {axis} {name}" for axis in "xyz"]
    radius = f"payload radius of gyration {name}"
    uneven = [f"payload uneven {element} {name}" for element in _UNEVEN]
    names = (mass, *moments, radius, *uneven)

    def lever(first: Array, mass_kg: float) -> Array:
        furthest_m = _FURTHEST * length_m
        return np.clip(first / max(mass_kg, _LEAST_KG), -furthest_m, furthest_m)

    def inertia(by: Array) -> Array:
        """(6, 6) by mass, first moments, radius and how uneven it is (10,): hardly bent by any."""
        mass_kg, first, own_radius = float(by[0]), by[1:4], float(by[4])
        d, moved = lever(first, mass_kg), skew(first)
        own = mass_kg * own_radius**2 * (np.eye(3) + _traceless(by[5:]))
        found = spatial_inertia(mass_kg, center, own)
        found[:3, 3:] -= moved
        found[3:, :3] += moved
        found[3:, 3:] -= skew(center) @ moved + moved @ skew(center) + mass_kg * skew(d) @ skew(d)
        return found

    @lru_cache(maxsize=2)  # for all postures
    def body(*by: float) -> tuple[Array, Array]:
        here = inertia(np.array(by))
        slopes = [(inertia(by + _STEP * way) - here) / _STEP for way in np.eye(len(by))]
        return frozen_array(here, np.float64), frozen_array(slopes, np.float64)

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        by = [values[name] for name in names]
        here, slopes = body(*by)
        assembly.add_inertia(link, here, np.append(by[0], by[0] * center + by[1:4]))
        for name, slope in zip(names, slopes, strict=True):
            assembly.inertia_of[name] = link, slope

    def place_m(values: Mapping[str, float]) -> Array:
        first = np.array([values[m] for m in moments])
        return np.asarray(center + lever(first, values[mass]))

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        return {"link": name, "point_m": place_m(values).tolist()}

    def is_also(values: Mapping[str, float], other: Instance) -> bool:
        """A body on a joint's axis moves as if on either link of that joint, but for its turn."""
        on_it = is_on_shared_axis(ordinary, link, place_m(values), other.place)
        return other.effect is WORDS and on_it

    return Instance(
        effect=WORDS,
        place=name,
        parameters=(
            Parameter(
                name=mass, unit="kg", mean=0.0, std=_STD * total, low=0.0, start=_START * total
            ),
            *(
                Parameter(name=m, unit="kg m", mean=0.0, std=_LEVER_STD * length_m * _STD * total)
                for m in moments
            ),
            Parameter(
                name=radius,
                unit="m",
                mean=_RADIUS * length_m,
                std=_RADIUS_STD * length_m,
                low=0.0,
                high=_LARGEST * length_m,
            ),
            *(
                Parameter(
                    name=element,
                    unit="",
                    mean=0.0,
                    std=_UNEVEN_STD,
                    untold=0.0,
                    low=-_UNEVEN_MOST,
                    high=_UNEVEN_MOST,
                )
                for element in uneven
            ),
        ),
        builder=build,
        describe=describe,
        is_also=is_also,
        size=mass,
        shapes=(radius, *uneven),
        material=min(_MATERIAL_KG, _MATERIAL * total),
    )


def _traceless(elements: Array) -> Array:
    """(3, 3) symmetric, of its elements xx, yy, xy, xz, yz."""
    xx, yy, xy, xz, yz = elements
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, -xx - yy]])
