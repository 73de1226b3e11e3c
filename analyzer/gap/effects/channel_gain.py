"""An accelerometer channel whose sensitivity is wrong, everywhere or at one point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "at_point", "instances", "of_file", "together"]

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
_GROUPS = ("xyz", "x", "y", "z")


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


def at_point(ordinary: Ordinary, axes: str, point: str) -> Instance:
    """Gains at one point alone: its mounting, its cable there.

    Parameters
    ----------
    axes
        One channel, ``"x"``; more with a gain each, ``"x+z"``; all with one gain, ``"xyz"``; or one
        of them with more than that, ``"xyz+x"``.
    """
    groups = axes.split("+")
    names = [f"ln gain {group} at {point}" for group in groups]
    index = ordinary.superset.point_index[point]

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        if assembly.mix is None:
            return
        mix = np.array(assembly.mix)
        for group, name in zip(groups, names, strict=True):
            for axis in group:
                mix[assembly.lines.sensor_point == index, "xyz".index(axis)] *= np.exp(values[name])
        assembly.mix = mix

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        del values
        return {"axis": axes, "sensor_point": point}

    return Instance(
        effect=WORDS,
        place=f"{'axis' if len(axes) == 1 else 'axes'} {axes} at point {point}",
        parameters=tuple(Parameter(name=n, unit="", mean=0.0, std=_WIDE) for n in names),
        builder=build,
        describe=describe,
        size=names[0],
        sizes=tuple(names) if len(names) > 1 else (),
        material=_MATERIAL_AT_POINT,
    )


def together(ordinary: Ordinary, first: Instance, second: Instance) -> Instance | None:
    """Return the one finding that gains of one sensor at one point are; None for others."""
    groups, points = [], []
    for instance in (first, second):
        if instance.effect is not WORDS or instance.describe is None:
            return None
        told = instance.describe({})
        groups += str(told["axis"]).split("+")
        points.append(str(told["sensor_point"]))
    return at_point(ordinary, _in_order(groups), points[0]) if points[0] == points[1] else None


def of_file(ordinary: Ordinary, description: Mapping[str, object]) -> Instance | None:
    """Return the gains at one point that an arm file describes; None where it does not."""
    axes, point = description.get("axis"), description.get("sensor_point")
    if not isinstance(axes, str) or point not in ordinary.superset.point_index:
        return None
    is_known = axes and axes == _in_order(axes.split("+"))
    return at_point(ordinary, axes, str(point)) if is_known else None


def _in_order(groups: Sequence[str]) -> str:
    return "+".join(group for group in _GROUPS if group in groups)
