"""Points that what goes round, sensor or hammer, was truly at, sought without a fit.

Every mounting is set beside the prediction at every other point, for two that were exchanged or one
that was another, and beside its slope along a shift of its place. A hit at another point may have
gone along as hits there do, or as recorded.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects import wrong_point
from armodal.analyzer.gap.effects.sensor_candidates import LEAST_GAIN
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel, Postures
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["channel_candidates"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_KEEP_SHIFTED, _KEEP_PLACES = 3, 2


def channel_candidates(
    stage: Stage, hypothesis: Hypothesis, values: Mapping[str, float]
) -> list[Candidate]:
    """Points exchanged, taken for others, or off their place, best first."""
    ordinary = hypothesis.ordinary
    ids = [point.id for point in ordinary.arm.points]
    n_points = len(ids)
    posture_of = {name: p for p, name in enumerate(ordinary.postures)}
    # Of a point's sensor or hits at another; hits along as there, or as recorded.
    gain = np.zeros((2, len(posture_of), n_points, n_points))
    slope = np.zeros((n_points, 3))
    curve = np.zeros((n_points, 3, 3))
    for model, lines, weighing in zip(stage.models, stage.lines, stage.weighings, strict=True):
        p = posture_of[lines.name]  # soft and hard hits share one
        posed = Postures([model], [lines])
        y = posed.response(hypothesis, values).values[0]
        own = weighing.cost_by_mounting(y)
        at = lines.moved_point
        for kept, predicted in enumerate(_ways(model, hypothesis, lines, values, y)):
            for other, there in predicted.items():
                cost = weighing.cost_by_mounting(there)
                np.add.at(gain[kept, p, :, other], at, own - cost)
        g, h = weighing.own_slopes(y, posed.by_shift(hypothesis, values)[:, 0])
        np.add.at(slope, at, g)
        np.add.at(curve, at, h)
    found = []
    for kept in (False, True):
        found += _exchanged(ordinary, ids, gain[int(kept)].sum(axis=0), kept=kept)
        found += _taken_for(ordinary, ids, gain[int(kept)], kept=kept)
    found += _for_all(stage, hypothesis, values, ids)
    step = -np.linalg.solve(curve + np.eye(3) / wrong_point.FAR_M**2, slope[..., None])[..., 0]
    gains = -0.5 * np.sum(step * slope, axis=1)
    for point in np.argsort(-gains)[:_KEEP_SHIFTED]:
        is_small = np.abs(step[point]).max() < 0.5 * wrong_point.MATERIAL_M
        if ordinary.superset.point_link[point] < 0 or is_small:
            continue
        instance = wrong_point.beside(ordinary, ids[point])
        shift = ordinary.arm.points[point].R_link_sensor @ step[point]
        begin = {**values, **dict(zip(instance.sizes, shift.tolist(), strict=True))}
        found.append(Candidate(instance=instance, gain=float(gains[point]), begin=begin))
    return sorted((c for c in found if c.gain > LEAST_GAIN), key=lambda c: -c.gain)


def _ways(
    model: PosedModel,
    hypothesis: Hypothesis,
    lines: PostureLines,
    values: Mapping[str, float],
    y: ComplexArray,
) -> list[dict[int, ComplexArray]]:
    """What every mounting (m, 3, L) records with what goes round at another point, by that point.

    Where the hammer goes round: with hits along as there, and as recorded.
    """
    still = (lines.sensor_point if lines.hammer_roves else lines.hit).tolist()
    row_of = {at: m for m, at in enumerate(zip(lines.moved_point.tolist(), still, strict=True))}
    as_there, as_recorded = {}, {}
    along: ComplexArray | None = None
    if lines.hammer_roves:
        along = _along_axes(model, hypothesis, lines, values)  # (m, 3, 3, L)
    for other in np.unique(lines.moved_point).tolist():
        rows = [row_of.get((other, at), m) for m, at in enumerate(still)]
        as_there[other] = y[rows]
        if along is not None:
            force = lines.hit_direction[lines.hit]
            as_recorded[other] = np.einsum("ma,macl->mcl", force, along[rows])
    return [as_there, as_recorded]


def _along_axes(
    model: PosedModel, hypothesis: Hypothesis, lines: PostureLines, values: Mapping[str, float]
) -> ComplexArray:
    """(m, 3, 3, L) what every mounting records of a unit hit along each of the base's axes."""
    n, m = len(lines.hit_point), len(lines.hit)
    beside = replace(
        lines,
        sensor_point=np.repeat(lines.sensor_point, 3),
        hit=(3 * lines.hit[:, None] + np.arange(3)).ravel(),
        hit_point=np.repeat(lines.hit_point, 3),
        hit_direction=np.tile(np.eye(3), (n, 1)),
    )
    y = model.values(hypothesis, beside, values)
    return y.reshape(m, 3, *y.shape[1:])


def _exchanged(ordinary: Ordinary, ids: list[str], gain: Array, *, kept: bool) -> list[Candidate]:
    both = np.triu(gain + gain.T, 1)
    found = []
    for flat in np.argsort(-both, axis=None)[:_KEEP_PLACES]:
        a, b = divmod(int(flat), len(ids))
        instance = wrong_point.exchanged(ordinary, ids[a], ids[b], kept=kept)
        found.append(Candidate(instance=instance, gain=float(both[a, b])))
    return found


def _for_all(
    stage: Stage, hypothesis: Hypothesis, values: Mapping[str, float], ids: list[str]
) -> list[Candidate]:
    """The point of what stays, exchanged with another for the sensor and the hammer alike.

    The first posture tells with which.
    """
    points = {point for own in stage.lines for point in own.still_point.tolist()}
    if len(points) != 1:
        return []
    still = points.pop()

    def brought(instances: Sequence[Instance], at: int) -> float:
        own = replace(hypothesis, instances=(*hypothesis.instances, *instances))
        y = Postures([stage.models[at]], [stage.lines[at]]).response(own, values).values[0]
        return float(np.sum(stage.weighings[at].cost_by_mounting(y)))

    others = sorted({*np.unique(stage.lines[0].moved_point).tolist()} - {still})
    tried = [
        wrong_point.exchanged(hypothesis.ordinary, ids[still], ids[other], kept=kept, still=True)
        for other in others
        for kept in (False, True)
    ]
    if not tried:
        return []
    best = min(tried, key=lambda instance: brought([instance], 0))
    gain = sum(brought([], at) - brought([best], at) for at in range(len(stage.lines)))
    return [Candidate(instance=best, gain=gain)]


def _taken_for(ordinary: Ordinary, ids: list[str], gain: Array, *, kept: bool) -> list[Candidate]:
    """One point that was another, in all postures or in one."""
    everywhere = gain.sum(axis=0)
    a, b = divmod(int(np.argmax(everywhere)), len(ids))
    instance = wrong_point.stood_at(ordinary, ids[a], ids[b], kept=kept)
    found = [Candidate(instance=instance, gain=float(everywhere[a, b]))]
    p, a, b = (int(i) for i in np.unravel_index(np.argmax(gain), gain.shape))
    instance = wrong_point.stood_at(ordinary, ids[a], ids[b], ordinary.postures[p], kept=kept)
    return [*found, Candidate(instance=instance, gain=float(gain[p, a, b]))]
