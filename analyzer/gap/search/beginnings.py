"""Effects that of no size change nothing, looked at from where their own files begin.

A linear look about no size is blind to them: a servo of no compliance is none, and of little it is
a part of the joint's own. What a beginning of some size leaves is looked at instead: first how much
of it ordinary errors can follow along the derivatives of the model without the effect, which costs
a quarter; then, for the best of each place and shape, the quadratic there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.inference.box import least_in_box
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.levenberg import promise
from armodal.analyzer.gap.model.effect import Instance

__all__ = ["LEADING", "promising_beginnings"]

LEADING = 2  # places and beginnings that a fit follows


def promising_beginnings(
    stage: Stage, about: Fit, instances: Sequence[Instance]
) -> list[tuple[Instance, list[tuple[float, Mapping[str, float]]]]]:
    """Return each instance with its beginnings and the cost they promise to take off, best first.

    What costs least where a fit begins may promise nothing, so every shape is asked for its promise
    where it begins best: what promises most may lead back to none, and the next not.

    Parameters
    ----------
    stage
        Lines broad enough that a beginning finds its way, and sharp enough to tell such an effect.
    about
        The present hypothesis fitted to them.
    instances
        Those that hide in no joint are left out: a linear look tells them.
    """
    blind = [(i, i.initial_values) for i in instances if i.hides_in and i.initial_values]
    if not blind:
        return []
    present = fit_hypothesis(stage, about.hypothesis, resumed=about, max_iterations=0)
    found: list[tuple[Instance, list[tuple[float, Mapping[str, float]]]]] = []
    for instance, beginnings in blind:
        best: dict[tuple[float, ...], tuple[float, Mapping[str, float]]] = {}
        for begin in beginnings(present.values):
            try:
                here = _followed(stage, present, instance, begin), begin
            except np.linalg.LinAlgError:
                continue
            shape = tuple(begin[name] for name in instance.shapes)
            best[shape] = max(best.get(shape, here), here, key=_first)
        looked = [(_promised(stage, present, instance, begin), begin) for _, begin in best.values()]
        if looked:
            found.append((instance, sorted(looked, key=_first, reverse=True)))
    return sorted(found, key=lambda entry: entry[1][0][0], reverse=True)


def _first(entry: tuple[float, Mapping[str, float]]) -> float:
    return entry[0]


def _promised(stage: Stage, present: Fit, instance: Instance, begin: Mapping[str, float]) -> float:
    """How much less a fit from a beginning promises to cost, by the quadratic there."""
    instances = (*present.hypothesis.instances, instance)
    richer = replace(present.hypothesis, instances=instances)
    try:
        there = fit_hypothesis(stage, richer, start=begin, max_iterations=0)
    except np.linalg.LinAlgError:
        return -np.inf
    return present.cost - there.cost + there.promised


def _followed(stage: Stage, present: Fit, instance: Instance, begin: Mapping[str, float]) -> float:
    """How much less it costs at a beginning, once all but the instance's own have followed."""
    hypothesis = replace(present.hypothesis, instances=(*present.hypothesis.instances, instance))
    space = hypothesis.space()
    u = space.start(begin)
    about = present.hypothesis, present.space, present.values
    misfit, along = stage.slope_about(about, hypothesis, space.values(u))
    there = u[[space.index[name] for name in present.space.index]]
    A, slope = present.curvature + np.eye(len(there)), along + there
    low, high = present.space.low - there, present.space.high - there
    follow = promise(A, slope, least_in_box(A, slope, low, high))
    return present.cost - misfit - 0.5 * float(u @ u) + follow
