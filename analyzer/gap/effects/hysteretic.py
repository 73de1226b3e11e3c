"""Joint losses that do not grow with frequency."""

from __future__ import annotations

from analyzer.gap.effects.effect import EffectWords, Instance
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="hysteretic",
    title="Hysteretic damping of the joints",
    changes="K becomes K (1 + i eta): the loss factor takes the place of the dashpots",
    signature="damping ratios that stay alike from low to high modes instead of growing",
    confused_with=("nonproportional_damping",),
    told_by="a posture that moves a mode far in frequency",
    remedy="use a loss factor for grease and seals instead of a dashpot",
)
_MATERIAL = 0.02


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One common loss factor of all joints: the null's small one without its limit."""
    del ordinary
    wide = Parameter(name="loss", mean=0.0, std=0.15, low=0.0, high=0.6, start=0.04)
    return (
        Instance(
            effect=WORDS,
            place="",
            relaxes={"loss": wide},
            size="loss",
            material=_MATERIAL,
            size_offset=0.02,
        ),
    )
