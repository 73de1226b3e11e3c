"""A joint that stands elsewhere than its encoder says."""

from __future__ import annotations

from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="encoder_offset",
    title="Encoder offset",
    changes="the posture: one joint's angle by a constant",
    signature="directions at all points beyond the joint turned alike, inertia as if displaced",
    confused_with=("flipped_axis",),
    told_by="the arm at its reference marks",
    remedy="master the joint again",
)
_MATERIAL_RAD = 0.012
_STD_RAD = 0.15


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each joint."""
    found = []
    for joint in ordinary.arm.joints:
        name = f"encoder {joint.name}"
        found.append(
            Instance(
                effect=WORDS,
                place=joint.name,
                relaxes={name: Parameter(name=name, unit="rad", mean=0.0, std=_STD_RAD)},
                size=name,
                material=_MATERIAL_RAD,
            )
        )
    return tuple(found)
