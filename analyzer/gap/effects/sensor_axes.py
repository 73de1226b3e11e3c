"""Axes of the accelerometer flipped or exchanged, everywhere or at one point."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["FLIPPED", "SWAPPED", "instances", "together", "turned_sensor"]

FLIPPED = EffectWords(
    name="flipped_axis",
    of_the_test=True,
    title="Sensor axis flipped",
    changes="the sign of a channel",
    signature="one channel agrees with the model after its sign is changed",
    confused_with=("swapped_axes", "wrong_point"),
    told_by="mount the sensor again and tap along each of its axes",
    remedy="one axis: correct its cable, measure again; two: its orientation in the arm file",
)
SWAPPED = EffectWords(
    name="swapped_axes",
    of_the_test=True,
    title="Sensor axes exchanged",
    changes="the order of the channels, signs too",
    signature="channels agree with the model's other axes",
    confused_with=("flipped_axis", "wrong_point"),
    told_by="mount the sensor again and tap along each of its axes",
    remedy="correct the order of the channels or the mounting, and measure again",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """None by itself: a scan in closed form proposes permutations (`sensor_candidates`)."""
    del ordinary
    return ()


def turned_sensor(
    ordinary: Ordinary, matrix: npt.NDArray[np.float64], point: str | None
) -> Instance:
    """A signed permutation of the sensor's axes, at one point or (None) everywhere."""
    at = None if point is None else ordinary.superset.point_index[point]
    is_flip = bool(np.all(np.diag(matrix) != 0.0))

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        del values
        if assembly.mix is None:
            return
        mix = np.array(assembly.mix)
        rows = slice(None) if at is None else assembly.lines.sensor_point == at
        mix[rows] = matrix @ mix[rows]
        assembly.mix = mix

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        del values
        return {"sensor_point": point or "", "axes": tuple(matrix.ravel().tolist())}

    where = "the roving sensor" if point is None else f"point {point}"
    recorded = ", ".join(
        f"{'xyz'[i]} is {'-' if row.sum() < 0 else ''}{'xyz'[int(np.argmax(np.abs(row)))]}"
        for i, row in enumerate(matrix)
        if row[i] != 1.0
    )
    return Instance(
        effect=FLIPPED if is_flip else SWAPPED,
        place=f"{where}: {recorded}",
        builder=build,
        describe=describe,
    )


def together(ordinary: Ordinary, first: Instance, second: Instance) -> Instance | None:
    """Return the one turn that two of the same sensor at the same point are; None for others."""
    matrices, points = [], []
    for instance in (first, second):
        if instance.effect not in (FLIPPED, SWAPPED) or instance.describe is None:
            return None
        told = instance.describe({})
        matrices.append(np.reshape(np.array(told["axes"]), (3, 3)))
        points.append(str(told["sensor_point"]))
    matrix = matrices[1] @ matrices[0]
    if points[0] != points[1] or np.array_equal(matrix, np.eye(3)):
        return None
    return turned_sensor(ordinary, matrix, points[0] or None)


def of_file(ordinary: Ordinary, description: Mapping[str, object]) -> Instance | None:
    """Return the instance an arm file describes; None where it does not."""
    axes, point = description.get("axes"), description.get("sensor_point")
    if not isinstance(axes, tuple) or len(axes) != 9 or not isinstance(point, str):
        return None
    if point and point not in ordinary.superset.point_index:
        return None
    return turned_sensor(ordinary, np.reshape(np.array(axes), (3, 3)), point or None)
