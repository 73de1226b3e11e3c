"""Play in a joint's transmission, closed by larger motion."""

from __future__ import annotations

from armodal.analyzer.gap.effects.level import (
    COVERED,
    COVERED_HERE,
    LEAST_BY_K,
    Slope,
    level_instances,
)
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="backlash",
    title="Play in a joint's transmission",
    changes="a joint's stiffness grows with the hit's level, since play takes less of the motion",
    signature="softer hits see a softer joint, most in postures whose weight does not close it",
    confused_with=("softening",),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="a posture in which gravity loads the joint: the play closes",
    remedy="set the play of gear or belt, or test in postures that load the joint",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint.

    A spring with play 2 h under a swing A > h is k (1 - (2 / pi) (asin z + z sqrt(1 - z^2))),
    z = h / A: it grows with A.
    """
    return level_instances(
        ordinary,
        WORDS,
        by_k=Slope(sense=1.0, std=0.2, low=0.0, high=0.8),
        by_c=Slope(sense=1.0, std=0.1, low=-0.6, high=0.6),
        size="k",
        material=LEAST_BY_K,
    )
