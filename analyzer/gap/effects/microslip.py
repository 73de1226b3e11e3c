"""A seat that slips little by little, more the larger the motion."""

from __future__ import annotations

from armodal.analyzer.gap.effects.level import (
    COVERED,
    COVERED_HERE,
    LEAST_BY_C,
    LEAST_BY_K,
    Slope,
    level_instances,
)
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="microslip",
    title="Seat of a joint slips little by little",
    changes="a joint's stiffness falls with the hit's level while its damping grows",
    signature="harder hits see a softer joint with more damping",
    confused_with=("softening", "friction"),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="hits between soft and hard: damping has its maximum where stiffness falls most",
    remedy="retorque bolted seats and clamps of the joint's drive",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint (W. D. Iwan, J. Appl. Mech. 33 (1966) 893).

    Damping grows with the level until all slips, is highest there, and falls beyond: where the
    highest lies between soft and hard hits both have about the same (`slips_or_softens`).
    """
    return level_instances(
        ordinary,
        WORDS,
        by_k=Slope(sense=-1.0, std=0.2, low=0.0, high=0.8),
        by_c=Slope(sense=1.0, std=0.3, low=-LEAST_BY_C, high=1.0),
        size="k",
        material=LEAST_BY_K,
    )
