"""A joint's bearing that gives way across the joint's axis."""

from __future__ import annotations

from dataclasses import replace

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.effects.effect import EffectWords, Instance
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="bearing",
    title="Bearing soft across its axis",
    changes="lets two rotations across the joint's axis give way, alike or nearly so",
    signature="the link beyond leans both ways across the joint's axis, about the joint",
    confused_with=("link_axis", "base"),
    told_by="points on both sides of the bearing; hits along two directions across the axis",
    remedy="check preload and bolts of the joint's main bearing",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each joint: the null's small compliance without its limit."""
    found = []
    for joint in ordinary.arm.joints:
        names = [f"bearing {side} {joint.name}" for side in "ab"]
        wide = compliance_parameter("", ordinary)
        relaxed: dict[str, Parameter] = {
            name: replace(wide, name=name, start=ordinary.bearing_limit) for name in names
        }
        found.append(
            Instance(
                effect=WORDS,
                place=joint.name,
                relaxes=relaxed,
                size=names[0],
                sizes=tuple(names),
                material=ordinary.bearing_limit,
                is_term=True,
            )
        )
    return tuple(found)
