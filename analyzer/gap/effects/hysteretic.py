"""Joint losses that do not grow with frequency."""

from __future__ import annotations

from dataclasses import replace

from armodal.analyzer.gap.effects.effect import EffectWords, Instance
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="hysteretic",
    title="Hysteretic damping of the joints",
    changes="K becomes K (1 + i eta): the loss factor takes the place of the dashpots",
    signature="damping ratios that stay alike from low to high modes instead of growing",
    confused_with=("nonproportional",),
    told_by="a posture that moves a mode far in frequency",
    remedy="use a loss factor for grease and seals instead of a dashpot",
)
_MATERIAL = 0.02
_ANY_LN_C = 2.0


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One common loss factor of all joints: the null's small one without its limit.

    It takes the place of the dashpots, so they may go.
    """
    believed = {p.name: p for p in ordinary.parameters() if p.name.startswith("ln c ")}
    gone = {name: replace(p, std=_ANY_LN_C) for name, p in believed.items()}
    wide = Parameter(name="loss", unit="", mean=0.0, std=0.15, low=0.0, high=0.6, start=0.04)
    return (
        Instance(
            effect=WORDS,
            place="",
            relaxes={"loss": wide, **gone},
            size="loss",
            material=_MATERIAL,
            size_offset=0.02,
        ),
    )
