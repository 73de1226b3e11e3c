"""The hammer's sensitivity is wrong."""

from __future__ import annotations

from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="hammer_gain",
    of_the_test=True,
    title="Hammer gain is wrong",
    changes="all FRFs by one factor",
    signature="every FRF too large or too small alike; masses and stiffnesses off by the factor",
    confused_with=("payload", "channel_gain"),
    told_by="a ratio calibration on a free, known mass; a known mass added to the arm",
    remedy="calibrate hammer and accelerometer together on a known mass",
)
_MATERIAL = 0.03
_WIDE = 0.4


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """The one hammer."""
    del ordinary
    wide = Parameter(name="ln hammer", unit="", mean=0.0, std=_WIDE)
    return (
        Instance(
            effect=WORDS,
            place="",
            relaxes={"ln hammer": wide},
            size="ln hammer",
            material=_MATERIAL,
        ),
    )
