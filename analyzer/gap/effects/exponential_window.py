"""An exponential window that a front end put on all records and nobody took off again."""

from __future__ import annotations

from collections.abc import Mapping

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="exponential_window",
    of_the_test=True,
    title="Exponential window not corrected",
    changes="the line s of every FRF to s + decay: all poles lie that much further left",
    signature="every mode loses the same 1/s beside its own damping, whatever its frequency",
    confused_with=("hysteretic", "nonproportional"),
    told_by="a record twice as long, or the same hit with the front end's window switched off",
    remedy="switch the front end's window off; of imported FRFs tell window_decay_rad_s",
)
_STD, _MATERIAL = 3.0, 0.3  # 1/s


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """The one front end."""
    del ordinary
    name = "window decay"

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        assembly.decay_rad_s += values[name]

    return (
        Instance(
            effect=WORDS,
            place="",
            parameters=(Parameter(name=name, unit="1/s", mean=0.0, std=_STD, low=0.0),),
            builder=build,
            size=name,
            material=_MATERIAL,
        ),
    )
