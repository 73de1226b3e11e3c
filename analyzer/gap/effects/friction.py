"""Dry friction in a joint: it holds back a part of the torque, whatever the motion."""

from __future__ import annotations

from armodal.analyzer.gap.effects.level import (
    COVERED,
    COVERED_HERE,
    LEAST_BY_C,
    Slope,
    level_instances,
)
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="friction",
    title="Dry friction in a joint",
    changes="a joint's damping falls with the hit's level, its stiffness too or not at all",
    signature="softer hits see a stiffer joint with more damping; it sticks as it dies away",
    confused_with=("microslip", "softening"),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="more levels, and the decay of one hard hit in windows",
    remedy="look at seals, brakes and the preload of the gear; test at the level of use",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint.

    A slider of limit T under a swing A takes 4 T A an oscillation: as a damper 4 T / (pi w A).
    """
    return level_instances(
        ordinary,
        WORDS,
        by_k=Slope(sense=-1.0, std=0.2, low=0.0, high=0.8),
        by_c=Slope(sense=-1.0, std=0.3, low=LEAST_BY_C, high=1.0),
        size="c",
        material=LEAST_BY_C,
    )
