"""A drive's rotor that turns with its joint: inertia reflected through the gear."""

from __future__ import annotations

from collections.abc import Mapping

from analyzer.gap.assembly import Assembly
from analyzer.gap.effects.effect import EffectWords, Instance
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.space import Parameter

__all__ = ["WORDS", "instances", "typical_moment"]

WORDS = EffectWords(
    name="rotor",
    title="Rotor's inertia at a joint",
    changes="adds to the joint's own diagonal of M, and to nothing else",
    signature="the joint's mode falls in every posture by the same inertia, whatever is beyond",
    confused_with=("servo", "payload"),
    told_by="a posture in which the joint carries little inertia; brakes on against servo",
    remedy="brakes on, or put the reflected inertia (ratio squared times rotor) into the model",
)
_MATERIAL = 0.05  # kg m^2


def typical_moment(ordinary: Ordinary, joint: int) -> float:
    """Return the largest moment of inertia of a joint's link about its frame, kg m^2."""
    link = ordinary.arm.joints[joint].link
    return float(link.inertia_kg_m2.diagonal().max() + link.mass_kg * (link.center_m**2).sum())


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint."""
    found = []
    for i in ordinary.elastic:
        joint = ordinary.arm.joints[i].name
        name = f"rotor {joint}"

        def build(
            assembly: Assembly,
            values: Mapping[str, float],
            joint: str = joint,
            name: str = name,
        ) -> None:
            at = assembly.names[joint]
            assembly.add_term("mass", at, at, values[name], parameter=name)

        found.append(
            Instance(
                effect=WORDS,
                place=joint,
                parameters=(
                    Parameter(name=name, mean=0.0, std=typical_moment(ordinary, i), low=0.0),
                ),
                builder=build,
                size=name,
                material=min(_MATERIAL, 0.1 * typical_moment(ordinary, i)),
            )
        )
    return tuple(found)
