"""An accelerometer channel whose sensitivity is wrong, everywhere or at one point."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "at_point", "instances"]

WORDS = EffectWords(
    name="channel_gain",
    of_the_test=True,
    title="Channel gain is wrong",
    changes="one channel of the accelerometer, by a factor",
    signature="one channel too large or too small at all frequencies and in all postures",
    confused_with=("flipped_axis",),
    told_by="a ratio calibration on a free, known mass, each axis in turn",
    remedy="check the channel's sensitivity in the set-up and on the certificate",
)
_MATERIAL = 0.05
# A sensor some millimetres off, or tilted, at one point looks like 6 % there.
_MATERIAL_AT_POINT = 0.08
_WIDE = 0.4


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each axis of the roving sensor."""
    del ordinary
    return tuple(
        Instance(
            effect=WORDS,
            place=f"axis {axis}",
            relaxes={
                f"ln gain {axis}": Parameter(name=f"ln gain {axis}", unit="", mean=0.0, std=_WIDE)
            },
            size=f"ln gain {axis}",
            material=_MATERIAL,
        )
        for axis in "xyz"
    )


def at_point(ordinary: Ordinary, axis: str, point: str) -> Instance:
    """A gain of one channel at one point alone: its mounting, its cable there."""
    name = f"ln gain {axis} at {point}"
    index = ordinary.superset.point_index[point]
    row = "xyz".index(axis)

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        if assembly.mix is None:
            return
        mix = np.array(assembly.mix)
        mix[assembly.lines.sensor_point == index, row] *= np.exp(values[name])
        assembly.mix = mix

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        del values
        return {"axis": axis, "sensor_point": point}

    return Instance(
        effect=WORDS,
        place=f"axis {axis} at point {point}",
        parameters=(Parameter(name=name, unit="", mean=0.0, std=_WIDE),),
        builder=build,
        describe=describe,
        size=name,
        material=_MATERIAL_AT_POINT,
    )


def of_file(ordinary: Ordinary, description: Mapping[str, object]) -> Instance | None:
    """Return the gain at one point that an arm file describes; None where it does not."""
    axis, point = description.get("axis"), description.get("sensor_point")
    if axis not in ("x", "y", "z") or point not in ordinary.superset.point_index:
        return None
    return at_point(ordinary, str(axis), str(point))
