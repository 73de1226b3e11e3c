"""An accelerometer that is heavier than the plan says: magnet, base, cable."""

from __future__ import annotations

from collections.abc import Mapping

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="sensor_mass",
    of_the_test=True,
    title="Accelerometer heavier than the plan says",
    changes="a mass at the sensor's place, which moves with it where it goes round",
    signature="frequencies differ from point to point, lower where the sensor moves much",
    confused_with=("payload", "wrong_point"),
    told_by="the same point with and without a known mass beside the sensor",
    remedy="weigh sensor, magnet and carried cable; put that in the plan and measure again",
)
_MATERIAL_KG = 0.01
_STD_KG = 1.0  # a magnet, a base and the cable that hangs on them: from grams to some kilograms


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """The one roving sensor."""
    del ordinary
    name = "sensor mass"

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        assembly.sensor_mass_kg += values[name]
        assembly.sensor_mass_of.append(name)

    return (
        Instance(
            effect=WORDS,
            place="",
            parameters=(Parameter(name=name, unit="kg", mean=0.0, std=_STD_KG, low=0.0),),
            builder=build,
            size=name,
            material=_MATERIAL_KG,
        ),
    )
