"""A joint that is softer for larger motion, without a loss of its own."""

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
    name="softening",
    title="Joint softens with larger motion",
    changes="a joint's stiffness falls with the hit's level; its damping stays",
    signature="frequencies fall with harder hits, damping does not change",
    confused_with=("microslip", "friction"),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="hits between soft and hard: their damping lies in between, too",
    remedy="give the joint's stiffness at the level of use; look at preloads that open",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint."""
    return level_instances(
        ordinary,
        WORDS,
        by_k=Slope(sense=-1.0, std=0.2, low=0.0, high=0.8),
        by_c=Slope(sense=1.0, with_k=0.4, std=0.02, low=-0.04, high=0.04),
        size="k",
        material=LEAST_BY_K,
    )
