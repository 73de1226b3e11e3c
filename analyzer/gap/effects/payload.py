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
_STD, _LEVER_STD_M = 0.1, 0.15  # of the arm's mass; of the moment, with that mass
_LEAST_KG, _FURTHEST_M = 0.02, 0.15
_STEP = 1e-6  # kg and kg m, for slopes
# Of gyration: from a compact tool flange to a spread gripper with hoses. No source: assumed.
_RADIUS_M, _RADIUS_STD_M, _LARGEST_M = 0.08, 0.07, 0.35


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
    total = sum(j.link.mass_kg for j in ordinary.arm.joints)
    mass = f"payload {name}"
    moments = [f"payload moment {axis} {name}" for axis in "xyz"]
    radius = f"payload radius of gyration {name}"
    names = (mass, *moments, radius)

    def lever(first: Array, mass_kg: float) -> Array:
        return np.clip(first / max(mass_kg, _LEAST_KG), -_FURTHEST_M, _FURTHEST_M)

    def inertia(by: Array) -> Array:
        """(6, 6) by mass, first moments and radius (5,): hardly bent by any."""
        mass_kg, first, own_radius = float(by[0]), by[1:4], float(by[4])
        d, moved = lever(first, mass_kg), skew(first)
        found = spatial_inertia(mass_kg, center, mass_kg * own_radius**2 * np.eye(3))
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
        mass_kg, *first, own_radius = (values[name] for name in names)
        here, slopes = body(mass_kg, *first, own_radius)
        assembly.add_inertia(link, here, np.append(mass_kg, mass_kg * center + first))
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
                Parameter(name=m, unit="kg m", mean=0.0, std=_LEVER_STD_M * _STD * total)
                for m in moments
            ),
            Parameter(
                name=radius,
                unit="m",
                mean=_RADIUS_M,
                std=_RADIUS_STD_M,
                low=0.0,
                high=_LARGEST_M,
            ),
        ),
        builder=build,
        describe=describe,
        is_also=is_also,
        size=mass,
        shapes=(radius,),
        material=min(_MATERIAL_KG, _MATERIAL * total),
    )
