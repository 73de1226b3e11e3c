"""Faults of the sensor's axes and gains, sought in closed form on every channel.

A recorded channel is set beside every axis of the prediction, with both signs; a signed
permutation of the axes at a point, or everywhere, is a sum of three such entries. That needs no
fit, so all 47 permutations are tried at every point; the best are then fitted like any effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations, product

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects import channel_gain, sensor_axes
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["LEAST_GAIN", "channel_candidates"]

Array = npt.NDArray[np.float64]

LEAST_GAIN = 12.0  # of cost, to be worth a fit
_LEAST_POINT_GAIN = 0.03  # relative; less is not worth a fit
_KEEP_POINTS = 3
_KEEP_EVERYWHERE = 2
_AXES = ("x", "y", "z", "xyz")


def channel_candidates(
    stage: Stage, hypothesis: Hypothesis, values: Mapping[str, float]
) -> list[Candidate]:
    """Faults of axes and gains that would lower the cost, best first."""
    ordinary = hypothesis.ordinary
    n_points = len(ordinary.arm.points)
    table = np.zeros((n_points, 3, 3, 2))
    slope = np.zeros((n_points, 3))
    curve = np.zeros((n_points, 3))
    measured = np.zeros(n_points, dtype=bool)
    for p, (lines, weighing) in enumerate(zip(stage.lines, stage.weighings, strict=True)):
        y = stage.models[p].values(hypothesis, lines, values)
        np.add.at(table, lines.sensor_point, weighing.cost_by_axis(y))
        g, h = weighing.gain_slopes(y)
        np.add.at(slope, lines.sensor_point, g)
        np.add.at(curve, lines.sensor_point, h)
        measured[lines.sensor_point] = True
    same = np.einsum("piis->pis", table)[..., 0].sum(axis=1)
    found: list[Candidate] = []
    costs = np.stack([_cost(table, matrix) for matrix in _OTHERS], axis=1)  # (points, 47)
    everywhere = same.sum() - costs.sum(axis=0)
    found += [
        _turned(ordinary, int(k), None, float(everywhere[k]))
        for k in np.argsort(-everywhere)[:_KEEP_EVERYWHERE]
    ]
    if measured.sum() > 1:  # at a single point a fault is one everywhere
        found += _at_points(ordinary, measured, same, costs, slope, curve)
    return sorted((c for c in found if c.gain > LEAST_GAIN), key=lambda c: -c.gain)


def _at_points(
    ordinary: Ordinary,
    measured: npt.NDArray[np.bool_],
    same: Array,
    costs: Array,
    slope: Array,
    curve: Array,
) -> list[Candidate]:
    """Axes and gains at single points, by costs as recorded (points,) and otherwise."""
    found = []
    gains = np.where(measured[:, None], same[:, None] - costs, -np.inf)
    best = np.argmax(gains, axis=1)
    for point in np.argsort(-gains[np.arange(len(best)), best])[:_KEEP_POINTS]:
        name = ordinary.arm.points[point].id
        found.append(_turned(ordinary, int(best[point]), name, float(gains[point, best[point]])))
    # Of each channel, and of all three by one gain.
    slope = np.column_stack([slope, slope.sum(axis=1)])
    curve = np.column_stack([curve, curve.sum(axis=1)])
    single = 0.5 * slope**2 / (curve + 1.0)
    for flat in np.argsort(-single, axis=None)[:_KEEP_POINTS]:
        point, row = divmod(int(flat), len(_AXES))
        if abs(slope[point, row]) < _LEAST_POINT_GAIN * (curve[point, row] + 1.0):
            continue
        instance = channel_gain.at_point(ordinary, _AXES[row], ordinary.arm.points[point].id)
        found.append(Candidate(instance=instance, gain=float(single[point, row])))
    return found


def _all_others() -> list[Array]:
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[np.arange(3), order] = signs
            if not np.array_equal(matrix, np.eye(3)):
                found.append(matrix)
    # A single flip or exchange is likelier than several at once; ties keep this order.
    return sorted(found, key=lambda m: float(np.sum(m != np.eye(3))))


_OTHERS = _all_others()


def _cost(table: Array, matrix: Array) -> Array:
    rows, columns = np.nonzero(matrix)
    signs = (matrix[rows, columns] < 0.0).astype(int)
    return np.asarray(table[:, rows, columns, signs].sum(axis=1))


def _turned(ordinary: Ordinary, k: int, point: str | None, gain: float) -> Candidate:
    instance: Instance = sensor_axes.turned_sensor(ordinary, _OTHERS[k], point)
    return Candidate(instance=instance, gain=gain)
