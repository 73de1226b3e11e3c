"""A sensor that stood at another point than the record says, or beside it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import Describer, EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "beside", "exchanged", "instances", "of_file", "stood_at"]

WORDS = EffectWords(
    name="wrong_point",
    of_the_test=True,
    title="Sensor stood at another point",
    changes="the place of some mountings; nothing of the arm",
    signature="one or two points alone disagree, and agree with the model at another place",
    confused_with=("swapped_axes", "flipped_axis", "channel_gain"),
    told_by="measure the named points again",
    remedy="correct the points' names in the session, or their place in the arm file",
)
_FAR_M, _MATERIAL_M = 0.1, 0.02


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """None by itself: a scan of all points proposes them (`sensor_candidates`)."""
    del ordinary
    return ()


def exchanged(ordinary: Ordinary, first: str, second: str) -> Instance:
    """Two points measured under each other's name."""
    a, b = (ordinary.superset.point_index[point] for point in (first, second))

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        del values
        points = _points(assembly)
        was_a, was_b = points == a, points == b
        points[was_a], points[was_b] = b, a
        assembly.sensor_point = points

    return Instance(
        effect=WORDS,
        place=f"points {first} and {second} exchanged",
        builder=build,
        describe=_saying({"exchanged": first, "with": second}),
    )


def stood_at(ordinary: Ordinary, point: str, other: str, posture: str | None = None) -> Instance:
    """A point's sensor at another point, in one posture or (None) all."""
    a, b = (ordinary.superset.point_index[name] for name in (point, other))

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        del values
        if posture is not None and assembly.lines.name != posture:
            return
        points = _points(assembly)
        points[assembly.lines.sensor_point == a] = b
        assembly.sensor_point = points

    where = "" if posture is None else f" in posture {posture}"
    words: dict[str, object] = {"point": point, "was": other}
    return Instance(
        effect=WORDS,
        place=f"point {point} was {other}{where}",
        builder=build,
        describe=_saying(words if posture is None else words | {"posture": posture}),
    )


def beside(ordinary: Ordinary, point: str) -> Instance:
    """A point off the place that the arm file gives, by a vector of its link's frame."""
    index = ordinary.superset.point_index[point]
    record = ordinary.arm.points[index]
    names = [f"shift {axis} of {point}" for axis in "xyz"]

    def shift(values: Mapping[str, float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        return np.array([values[name] for name in names])

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        assembly.shifts_m[index] = record.R_link_sensor.T @ shift(values)

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        return {"point": point, "by_m": shift(values).tolist()}

    return Instance(
        effect=WORDS,
        place=f"point {point}",
        parameters=tuple(Parameter(name=name, unit="m", mean=0.0, std=_FAR_M) for name in names),
        builder=build,
        describe=describe,
        size=names[0],
        sizes=tuple(names),
        material=_MATERIAL_M,
    )


def of_file(ordinary: Ordinary, description: Mapping[str, object]) -> Instance | None:
    """Return the instance that an arm file describes; None where its words or points are not known.

    The shift of a point is a parameter and not read here.
    """
    known = {key: str(value) for key, value in description.items() if isinstance(value, str)}
    points = [known[key] for key in ("exchanged", "with", "point", "was") if key in known]
    if any(point not in ordinary.superset.point_index for point in points):
        return None
    if "exchanged" in known and "with" in known:
        return exchanged(ordinary, known["exchanged"], known["with"])
    if "point" in known and "was" in known:
        return stood_at(ordinary, known["point"], known["was"], known.get("posture"))
    return beside(ordinary, known["point"]) if "point" in known else None


def _saying(words: dict[str, object]) -> Describer:
    def describe(values: Mapping[str, float]) -> dict[str, object]:
        del values
        return words

    return describe


def _points(assembly: Assembly) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    known = assembly.lines.sensor_point if assembly.sensor_point is None else assembly.sensor_point
    return np.array(known)
