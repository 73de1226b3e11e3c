"""Faults of the sensor's axes, gains and places, sought in closed form on every channel.

A recorded channel is set beside every axis of the prediction, with both signs; a signed
permutation of the axes at a point, or everywhere, is a sum of three such entries. That needs no
fit, so all 47 permutations are tried at every point; the best are then fitted like any effect.
Likewise every mounting is set beside the prediction at every other point, for two that were
exchanged, and beside its slope along a shift of its place.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations, product

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects import channel_gain, sensor_axes, wrong_point
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["channel_candidates"]

Array = npt.NDArray[np.float64]

_LEAST_GAIN = 12.0  # of cost, to be worth a fit
_LEAST_POINT_GAIN = 0.03  # relative; less is not worth a fit
_KEEP_POINTS = 3
_KEEP_EVERYWHERE = 2
_KEEP_PLACES = 2
_SHIFT_STD_M, _LEAST_SHIFT_M = 0.1, 0.01


def channel_candidates(
    stage: Stage, hypothesis: Hypothesis, values: Mapping[str, float]
) -> list[Candidate]:
    """Faults of axes, single gains and places that would lower the cost, best first."""
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
    gains = np.where(measured[:, None], same[:, None] - costs, -np.inf)
    best = np.argmax(gains, axis=1)
    for point in np.argsort(-gains[np.arange(n_points), best])[:_KEEP_POINTS]:
        name = ordinary.arm.points[point].id
        found.append(_turned(ordinary, int(best[point]), name, float(gains[point, best[point]])))
    single = 0.5 * slope**2 / (curve + 1.0)
    for flat in np.argsort(-single, axis=None)[:_KEEP_POINTS]:
        point, row = divmod(int(flat), 3)
        if abs(slope[point, row]) < _LEAST_POINT_GAIN * (curve[point, row] + 1.0):
            continue
        instance = channel_gain.at_point(ordinary, "xyz"[row], ordinary.arm.points[point].id)
        found.append(Candidate(instance=instance, gain=float(single[point, row])))
    found += _elsewhere(stage, hypothesis, values)
    return sorted((c for c in found if c.gain > _LEAST_GAIN), key=lambda c: -c.gain)


def _elsewhere(
    stage: Stage, hypothesis: Hypothesis, values: Mapping[str, float]
) -> list[Candidate]:
    """Points exchanged, points taken for others, points off their place."""
    ordinary = hypothesis.ordinary
    ids = [point.id for point in ordinary.arm.points]
    n_points = len(ids)
    posture_of = {name: p for p, name in enumerate(ordinary.postures)}
    gain = np.zeros((len(posture_of), n_points, n_points))  # of a point's sensor at another
    slope = np.zeros((n_points, 3))
    curve = np.zeros((n_points, 3, 3))
    for model, lines, weighing in zip(stage.models, stage.lines, stage.weighings, strict=True):
        p = posture_of[lines.name]  # soft and hard hits share one
        response = Postures([model], [lines]).response(hypothesis, values)
        y = response.values[0]
        own = weighing.cost_by_mounting(y).sum(axis=1)
        row_of = {
            (int(point), int(hit)): m
            for m, (point, hit) in enumerate(zip(lines.sensor_point, lines.hit, strict=True))
        }
        for other in np.unique(lines.sensor_point):
            rows = np.array([row_of.get((int(other), int(hit)), -1) for hit in lines.hit])
            cost = weighing.cost_by_mounting(y[rows]).sum(axis=1)
            np.add.at(gain[p, :, other], lines.sensor_point, np.where(rows < 0, 0.0, own - cost))
        g, h = weighing.own_slopes(y, response.by_shift()[:, 0])
        np.add.at(slope, lines.sensor_point, g)
        np.add.at(curve, lines.sensor_point, h)
    found = [*_exchanged(ordinary, ids, gain.sum(axis=0)), *_taken_for(ordinary, ids, gain)]
    step = -np.linalg.solve(curve + np.eye(3) / _SHIFT_STD_M**2, slope[..., None])[..., 0]
    gains = -0.5 * np.sum(step * slope, axis=1)
    for point in np.argsort(-gains)[:_KEEP_POINTS]:
        if ordinary.superset.point_link[point] < 0 or np.abs(step[point]).max() < _LEAST_SHIFT_M:
            continue
        instance = wrong_point.beside(ordinary, ids[point])
        shift = ordinary.arm.points[point].R_link_sensor @ step[point]
        begin = {**values, **dict(zip(instance.sizes, shift.tolist(), strict=True))}
        found.append(Candidate(instance=instance, gain=float(gains[point]), begin=begin))
    return found


def _exchanged(ordinary: Ordinary, ids: list[str], gain: Array) -> list[Candidate]:
    both = np.triu(gain + gain.T, 1)
    found = []
    for flat in np.argsort(-both, axis=None)[:_KEEP_PLACES]:
        a, b = divmod(int(flat), len(ids))
        instance = wrong_point.exchanged(ordinary, ids[a], ids[b])
        found.append(Candidate(instance=instance, gain=float(both[a, b])))
    return found


def _taken_for(ordinary: Ordinary, ids: list[str], gain: Array) -> list[Candidate]:
    """One point that was another, in all postures or in one."""
    everywhere = gain.sum(axis=0)
    a, b = divmod(int(np.argmax(everywhere)), len(ids))
    found = [
        Candidate(
            instance=wrong_point.stood_at(ordinary, ids[a], ids[b]), gain=float(everywhere[a, b])
        )
    ]
    p, a, b = (int(i) for i in np.unravel_index(np.argmax(gain), gain.shape))
    instance = wrong_point.stood_at(ordinary, ids[a], ids[b], ordinary.postures[p])
    return [*found, Candidate(instance=instance, gain=float(gain[p, a, b]))]


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
