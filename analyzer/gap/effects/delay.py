"""A delay between hammer and accelerometer."""

from __future__ import annotations

from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="delay",
    of_the_test=True,
    title="Delay between hammer and accelerometer",
    changes="all FRFs by e^(-s delay)",
    signature="a phase that grows with frequency alike in all FRFs",
    confused_with=("hysteretic",),
    told_by="hammer and accelerometer face to face: the phase of a free mass is zero",
    remedy="check filters and converter settings of both channels",
)
_MATERIAL_S = 1.0e-4
_STD_S = 1e-3


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """The one delay."""
    del ordinary
    wide = Parameter(name="delay", unit="s", mean=0.0, std=_STD_S)
    return (
        Instance(
            effect=WORDS, place="", relaxes={"delay": wide}, size="delay", material=_MATERIAL_S
        ),
    )
