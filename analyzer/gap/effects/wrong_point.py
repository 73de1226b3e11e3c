"""What goes round, sensor or hammer, was at another point than the record says, or beside it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import Describer, EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = [
    "FAR_M",
    "MATERIAL_M",
    "WORDS",
    "beside",
    "exchanged",
    "instances",
    "of_file",
    "stood_at",
]

WORDS = EffectWords(
    name="wrong_point",
    of_the_test=True,
    title="Point taken for another",
    changes="where some sensors stood or hits fell; nothing of the arm",
    signature="one or two points alone disagree, and agree with the model at another place",
    confused_with=("swapped_axes", "flipped_axis", "channel_gain"),
    told_by="measure the named points again",
    remedy="mark and measure these points again; a measured session is not corrected",
)
FAR_M, MATERIAL_M = 0.1, 0.02
_KEPT, _STILL = "hits_along", "what_stays"


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """None by itself: a scan of all points proposes them (`sensor_candidates`)."""
    del ordinary
    return ()


def exchanged(
    ordinary: Ordinary, first: str, second: str, *, kept: bool = False, still: bool = False
) -> Instance:
    """Two points measured under each other's name.

    `kept`: hits went along as recorded, rather than as hits at the other point do. `still`: what
    does not go round stood at the other point, too.
    """
    a, b = (ordinary.superset.point_index[point] for point in (first, second))

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        del values
        _move(assembly, {a: b, b: a}, kept=kept, still=still)

    words: dict[str, object] = {"exchanged": first, "with": second}
    return Instance(
        effect=WORDS,
        place=f"points {first} and {second} exchanged{', for all' if still else ''}",
        builder=build,
        describe=_saying(words | _hits(kept) | ({_STILL: "too"} if still else {})),
    )


def stood_at(
    ordinary: Ordinary, point: str, other: str, posture: str | None = None, *, kept: bool = False
) -> Instance:
    """A point's sensor or hits at another point, in one posture or (None) all; `kept` as above."""
    a, b = (ordinary.superset.point_index[name] for name in (point, other))

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        del values
        if posture is not None and assembly.lines.name != posture:
            return
        _move(assembly, {a: b}, kept=kept)

    where = "" if posture is None else f" in posture {posture}"
    words: dict[str, object] = {"point": point, "was": other} | _hits(kept)
    return Instance(
        effect=WORDS,
        place=f"point {point} was {other}{where}",
        builder=build,
        describe=_saying(words if posture is None else words | {"posture": posture}),
        of_one_posture=posture is not None,
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
        parameters=tuple(Parameter(name=name, unit="m", mean=0.0, std=FAR_M) for name in names),
        builder=build,
        describe=describe,
        size=names[0],
        sizes=tuple(names),
        material=MATERIAL_M,
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
        kept, still = (key in known for key in (_KEPT, _STILL))
        return exchanged(ordinary, known["exchanged"], known["with"], kept=kept, still=still)
    if "point" in known and "was" in known:
        where = known.get("posture")
        return stood_at(ordinary, known["point"], known["was"], where, kept=_KEPT in known)
    return beside(ordinary, known["point"]) if "point" in known else None


def _saying(words: dict[str, object]) -> Describer:
    def describe(values: Mapping[str, float]) -> dict[str, object]:
        del values
        return words

    return describe


def _hits(kept: bool) -> dict[str, object]:
    return {_KEPT: "as recorded"} if kept else {}


def _move(assembly: Assembly, to: Mapping[int, int], *, kept: bool, still: bool = False) -> None:
    """Put what goes round to other points; a hit goes along as one there does, or as recorded.

    `still`: and what does not, a hit then along as recorded where nothing else hits the other.
    """
    struck, forces = assembly.struck, assembly.forces
    if still or not assembly.lines.hammer_roves:
        moved = [to.get(point, point) for point in assembly.where.tolist()]
        assembly.sensor_point = np.array(moved)
    if still or assembly.lines.hammer_roves:
        row_of = {point: row for row, point in enumerate(struck.tolist())}
        truly = [to.get(point, point) for point in struck.tolist()]
        assembly.hit_point = np.array(truly)
        if not kept:
            assembly.force = forces[[row_of.get(point, row) for row, point in enumerate(truly)]]
