"""Joint losses that do not grow with frequency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.priors import JOINT_LOSS_LIMIT
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="hysteretic",
    title="Hysteretic damping of the joints",
    changes="K becomes K (1 + i eta) at 30 Hz, stiffer above: in place of the dashpots",
    signature="damping ratios that stay alike from low to high modes instead of growing",
    confused_with=("nonproportional",),
    told_by="a posture that moves a mode far in frequency",
    remedy="use a loss factor for grease and seals instead of a dashpot",
)
_ANY_LN_C = 2.0
_STD, _MOST, _START = 0.15, 0.6, 0.04


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Loss factors of all joints: the null's small ones without their limit.

    They take the place of the dashpots, so those may go.
    """
    believed = {p.name: p for p in ordinary.parameters() if p.name.startswith("ln c ")}
    gone = {name: replace(p, std=_ANY_LN_C) for name, p in believed.items()}

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        """Let no loss grow with frequency."""
        del values
        assembly.loss_power, assembly.loss_power_is_free = 0.0, False

    names = [f"loss {ordinary.arm.joints[i].name}" for i in ordinary.elastic]
    wide = Parameter(name="", unit="", mean=0.0, std=_STD, low=0.0, high=_MOST, start=_START)
    return (
        Instance(
            effect=WORDS,
            place="",
            builder=build,
            relaxes={**{name: replace(wide, name=name) for name in names}, **gone},
            size=names[0],
            sizes=tuple(names),
            size_offset=JOINT_LOSS_LIMIT,
        ),
    )
