"""A joint believed rigid that gives way about its own axis."""

from __future__ import annotations

from dataclasses import replace

from armodal.analyzer.gap.effects.compliance import bearing_loss, compliance_parameter
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="released_joint",
    title="Joint believed rigid is elastic",
    changes="releases the joint's rotation: one more degree of freedom with a spring and a damper",
    signature="one more mode, turning about the joint's own axis at its place in every posture",
    confused_with=("link_axis", "bearing", "coupling"),
    told_by="a posture that turns the joint's axis away from its neighbours', a hit far off it",
    remedy="check its brake and transmission; the new arm file has its stiffness",
)
_MATERIAL = 0.05  # of its drive's compliance


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each joint without a stiffness: the null's small compliance without its limit."""
    found = []
    for number, joint in enumerate(ordinary.arm.joints):
        if joint.stiffness is not None:
            continue
        name = f"compliance of {joint.name}"
        wide = compliance_parameter(name, ordinary, number)
        found.append(
            Instance(
                effect=WORDS,
                place=joint.name,
                relaxes={
                    name: replace(wide, start=ordinary.scale(number)),
                    **bearing_loss(joint.name),
                },
                size=name,
                material=_MATERIAL * ordinary.scale(number),
                drives=ordinary.drives(number),
                is_term=True,
            )
        )
    return tuple(found)
