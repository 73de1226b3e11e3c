"""Something bolted to a link that nobody told the model of."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from analyzer.gap.assembly import Assembly
from analyzer.gap.effects.effect import EffectWords, Instance
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.space import Parameter

__all__ = ["WORDS", "instances"]

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
_PLACE_STD_M = 0.08
_RADIUS_M, _RADIUS_STD_M = 0.04, 0.03  # of gyration


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each link from the third on: what hangs on the others changes little."""
    total = sum(joint.link.mass_kg for joint in ordinary.arm.joints)
    found = []
    last = len(ordinary.arm.joints) - 1
    for link, joint in enumerate(ordinary.arm.joints):
        if link < 2 or link == last - 1:
            continue
        name = joint.link.name
        mass = f"payload {name}"
        at = [f"payload {axis} {name}" for axis in "xyz"]
        radius = f"payload radius {name}"
        center = joint.link.center_m

        def build(
            assembly: Assembly,
            values: Mapping[str, float],
            link: int = link,
            mass: str = mass,
            at: list[str] = at,
            radius: str = radius,
        ) -> None:
            place = np.array([values[a] for a in at])
            own = values[radius] ** 2 * values[mass] * np.eye(3)
            assembly.add_body(link, values[mass], place, own)

        found.append(
            Instance(
                effect=WORDS,
                place=name,
                parameters=(
                    Parameter(name=mass, mean=0.0, std=0.05 * total, low=0.0),
                    *(
                        Parameter(name=a, mean=float(c), std=_PLACE_STD_M)
                        for a, c in zip(at, center, strict=True)
                    ),
                    Parameter(name=radius, mean=_RADIUS_M, std=_RADIUS_STD_M, low=0.0),
                ),
                builder=build,
                size=mass,
                material=_MATERIAL_KG,
            )
        )
    return tuple(found)
