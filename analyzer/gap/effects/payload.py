"""Something bolted to a link that nobody told the model of."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import Assembly
from analyzer.gap.effects.effect import EffectWords, Instance
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.space import Parameter

__all__ = ["WORDS", "instances"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="payload",
    title="Unknown body on a link",
    changes="mass, first moments and inertia of a rigid body on a link",
    signature="frequencies fall together with the share that the link has in each mode",
    confused_with=("rotor", "hammer_gain"),
    told_by="a known mass added at the same place",
    remedy="weigh what the link carries: tool, valves, cables; put it into the arm file",
)
_MATERIAL_KG = 0.2
_PLACE_STD_M, _FURTHEST_M = 0.08, 0.15  # from the link's centre
_MOMENT_STD_KG_M = 0.2
_RADIUS_M, _RADIUS_STD_M = 0.04, 0.03  # of gyration


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each link from the third on: what hangs on the others changes little."""
    last = len(ordinary.arm.joints) - 1
    links = [i for i in range(2, last + 1) if i != last - 1]
    return tuple(_on(ordinary, link) for link in links)


def _on(ordinary: Ordinary, link: int) -> Instance:
    joint = ordinary.arm.joints[link]
    name, center = joint.link.name, joint.link.center_m
    total = sum(j.link.mass_kg for j in ordinary.arm.joints)
    mass, radius = f"payload {name}", f"payload radius {name}"
    at = [f"payload {axis} {name}" for axis in "xyz"]

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        place = np.array([values[a] for a in at])
        own = values[radius] ** 2 * values[mass] * np.eye(3)
        assembly.add_body(link, values[mass], place, own)

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        return {"link": name, "point_m": [values[a] for a in at]}

    def begin(values: Mapping[str, float]) -> dict[str, float]:
        kg = max(values[mass], _MATERIAL_KG / 2.0)
        shift = np.array([values[f"{a} moment"] for a in at]) / kg
        place = center + np.clip(shift, -_FURTHEST_M, _FURTHEST_M)
        return {mass: kg, **dict(zip(at, place.tolist(), strict=True))}

    heavy = Parameter(name=mass, mean=0.0, std=0.05 * total, low=0.0)
    return Instance(
        effect=WORDS,
        place=name,
        parameters=(
            heavy,
            *(
                Parameter(name=a, mean=float(c), std=_PLACE_STD_M)
                for a, c in zip(at, center, strict=True)
            ),
            Parameter(name=radius, mean=_RADIUS_M, std=_RADIUS_STD_M, low=0.0),
        ),
        builder=build,
        describe=describe,
        probe=_probe(link, heavy, center, at),
        begin=begin,
        size=mass,
        material=_MATERIAL_KG,
    )


def _probe(link: int, heavy: Parameter, center: Array, at: list[str]) -> Instance:
    """Mass and first moments, in which the equations are linear: for the look at zero."""
    moments = [f"{a} moment" for a in at]

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        more = np.array([values[m] for m in moments])
        own = _RADIUS_M**2 * values[heavy.name] * np.eye(3)
        assembly.add_small_body(link, values[heavy.name], center, more, own)

    return Instance(
        effect=WORDS,
        place="",
        parameters=(heavy, *(Parameter(name=m, mean=0.0, std=_MOMENT_STD_KG_M) for m in moments)),
        builder=build,
        size=heavy.name,
    )
