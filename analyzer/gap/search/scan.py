"""Which effects could explain what the present hypothesis does not: a linear look at all of them.

About the present best point every effect is a few more columns beside the ordinary ones. The gain
of an effect is what those columns take off the cost after the ordinary parameters have moved too,
priors and signs included.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.box import least_in_box
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.space import Space

__all__ = ["LOOK", "Candidate", "scan_instances", "small"]

Array = npt.NDArray[np.float64]

LOOK = 8.0  # of cost: what promises less brings nothing that could be told


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """An instance, and what it promises."""

    instance: Instance
    gain: float  # of cost, linear
    size: float = float("nan")  # what a linear look makes of its size parameter
    size_std: float = float("nan")
    begin: Mapping[str, float] = field(default_factory=dict)  # values a fit begins with
    # What each ordinary parameter does, in its own unit, per unit of the size.
    follow: Mapping[str, float] = field(default_factory=dict)


def scan_instances(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> list[Candidate]:
    """Linear gain of every instance on top of a fit, best first."""
    space, gradient, curvature = _wide(stage, fit, instances)
    ordinary = np.array([p.name in fit.space.index for p in space.parameters])
    free = np.flatnonzero(ordinary)[fit.free]
    left = gradient[free] + fit.u[fit.free]  # where the fit has not converged
    found = []
    for instance in instances:
        if not instance.parameters or instance.relaxes:
            found.append(_relaxed(fit, instance, space, gradient, curvature))
            continue
        names = [p.name for p in instance.parameters]
        own = np.array([space.index[n] for n in names])
        sizes = (instance.size, *instance.sizes)
        one_sided = np.array([p.low >= 0.0 and p.name in sizes for p in instance.parameters])
        gain, step, stds, follow, along = _gain(gradient, curvature, free, own, one_sided, left)
        at = names.index(instance.size)
        unit = space.std[own]
        reached = dict(zip(names, (space.mean[own] + step * unit).tolist(), strict=True))
        u = np.clip(fit.u[fit.free] + follow, fit.space.low[fit.free], fit.space.high[fit.free])
        moved = fit.u.copy()
        moved[fit.free] = u
        found.append(
            Candidate(
                instance=instance,
                gain=gain,
                size=float(step[at] * unit[at]),
                size_std=float(stds[at] * unit[at]),
                begin={**fit.space.values(moved), **reached},
                follow=dict(
                    zip(
                        np.array(list(fit.space.index))[fit.free].tolist(),
                        (along[:, at] * fit.space.std[fit.free] / unit[at]).tolist(),
                        strict=True,
                    )
                ),
            )
        )
    return sorted(found, key=lambda c: -c.gain)


def _wide(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> tuple[Space, Array, Array]:
    """Space, gradient and curvature of a fit's hypothesis with all of the instances at no size."""
    new = [replace(small(i), relaxes={}) for i in instances if i.parameters]
    wide = replace(fit.hypothesis, instances=(*fit.hypothesis.instances, *new))
    space = wide.space()
    values = {**{p.name: p.first for p in space.parameters}, **fit.values}
    whole, _ = stage.whole_quadratic(wide, space, values, range(len(stage.lines)))
    return space, whole.gradient, whole.curvature


def small(instance: Instance) -> Instance:
    """Return the instance with its size at zero, so that it changes nothing yet."""
    if not instance.size or instance.size_offset:
        return instance
    parameters = tuple(
        replace(p, start=0.0) if p.name in (instance.size, *instance.sizes) else p
        for p in instance.parameters
    )
    return replace(instance, parameters=parameters)


def _gain(
    gradient: Array,
    curvature: Array,
    free: npt.NDArray[np.int64],
    own: npt.NDArray[np.int64],
    one_sided: npt.NDArray[np.bool_],
    left: Array,
) -> tuple[float, Array, Array, Array, Array]:
    """Cost that the own columns take off when the free ones follow; one-sided ones only grow.

    `left` (n_free,) is the free ones' slope: what they gain without the own ones does not count.

    Returns the gain, the step (n_own,), its standard deviation, each alone, how the free ones
    follow (n_free,), and how they do per unit of each (n_free, n_own).
    """
    A = curvature[np.ix_(free, free)] + np.eye(len(free))
    B = curvature[np.ix_(free, own)]
    along = np.linalg.solve(A, B)
    S = curvature[np.ix_(own, own)] + np.eye(len(own)) - B.T @ along
    own_way = np.linalg.solve(A, left)
    slope = gradient[own] - B.T @ own_way
    std: Array = 1.0 / np.sqrt(S.diagonal())
    active = ~(one_sided & (slope >= 0.0))
    whole: Array = np.zeros(len(own))
    for _ in own:
        if not active.any():
            break
        step = -np.linalg.solve(S[np.ix_(active, active)], slope[active])
        wrong = one_sided[active] & (step < 0.0)
        if not wrong.any():
            whole[active] = step
            gain = -0.5 * float(step @ slope[active])
            follow: Array = np.asarray(-along @ whole - own_way)
            return gain, whole, std, follow, np.asarray(-along)
        active[np.flatnonzero(active)[wrong]] = False
    return 0.0, whole, std, np.asarray(-own_way), np.asarray(-along)


def _relaxed(
    fit: Fit, instance: Instance, space: Space, gradient: Array, curvature: Array
) -> Candidate:
    """What is gained when priors become wide, within their bounds; size, deviation, what follows.

    Parameters it brings beside move too. The fit's own slope, where it has not converged or rests
    at a limit, counts with both priors.

    Parameters
    ----------
    space, gradient, curvature
        Of the data, with all instances at no size.
    """
    brought = [p.name for p in instance.parameters]
    names = [*fit.space.index, *brought]
    at = np.array([space.index[name] for name in names])
    mean, unit = space.mean[at], space.std[at]
    first = [(p.first - p.mean) / p.std for p in small(instance).parameters]
    u = np.concatenate([fit.u, first])
    wide = curvature[np.ix_(at, at)] + np.eye(len(at))
    slope = gradient[at] + u
    free = np.concatenate([fit.free, np.ones(len(brought), dtype=bool)])
    low, high = np.full(len(at), -np.inf), np.full(len(at), np.inf)
    was = np.flatnonzero(fit.free)
    gain = -0.5 * float(slope[was] @ np.linalg.solve(wide[np.ix_(was, was)], slope[was]))
    for name, prior in instance.relaxes.items():
        i = fit.space.index[name]
        narrow = unit[i]
        keep = (narrow / prior.std) ** 2
        there = u[i] + (mean[i] - prior.mean) / narrow
        wide[i, i] += keep - 1.0
        slope[i] += keep * there - u[i]
        free[i] = True
        gain += 0.5 * (u[i] ** 2 - keep * there**2)
        low[i] = (prior.low - mean[i]) / narrow - u[i]
        high[i] = (prior.high - mean[i]) / narrow - u[i]
    now = np.flatnonzero(free)
    W = wide[np.ix_(now, now)]
    step = least_in_box(W, slope[now], low[now], high[now])
    gain -= float(slope[now] @ step + 0.5 * step @ W @ step)
    if instance.size not in names:
        return Candidate(instance=instance, gain=gain)
    i = names.index(instance.size)
    k = int(np.flatnonzero(now == i)[0])
    inverse = np.linalg.inv(W)
    follow = inverse[:, k] / inverse[k, k] * unit[now] / unit[i]
    return Candidate(
        instance=instance,
        gain=gain,
        size=float(mean[i] + unit[i] * (u[i] + step[k])),
        size_std=float(unit[i] * np.sqrt(inverse[k, k])),
        follow={
            names[n]: per
            for n, per in zip(now.tolist(), follow.tolist(), strict=True)
            if n < len(fit.u)
        },
    )
