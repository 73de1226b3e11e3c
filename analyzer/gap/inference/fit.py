"""Fit of one hypothesis by Levenberg's steps, its priors and bounds included.

Vectors count prior standard deviations, so the prior's curvature is the identity. At a bound a
parameter whose slope points outward rests.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.box import least_in_box
from armodal.analyzer.gap.inference.levenberg import (
    FIRST_DAMPING,
    damped_step,
    next_damping,
    promise,
)
from armodal.analyzer.gap.inference.stage import Stage, models_of
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.linearised import linearised, linearised_near
from armodal.analyzer.gap.model.priors import FARTHEST
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.weigh import Quadratic

__all__ = [
    "TOLERANCE",
    "Fit",
    "Stage",
    "best_starting_point",
    "cost_at",
    "cost_of",
    "fit_hypothesis",
    "models_of",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

TOLERANCE = 0.05  # of cost
_EDGE = 1e-9
_TRIALS = 6  # of a step, each more damped
_PART = 2e-5  # of the cost: a step that gains less ends a fit, however far from the data it is
_NOTHING = 0.2  # of the tolerance: a step that promises less is not tried


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """A hypothesis at its best point."""

    hypothesis: Hypothesis
    space: Space
    u: Array  # (n,)
    cost: float  # chi^2 / 2 + prior
    misfit: tuple[float, ...]  # chi^2 / 2 of each posture used
    curvature: Array  # (n, n) of the data at u
    slope: Array  # (n,) of the cost; not zero at bounds
    free: npt.NDArray[np.bool_]  # (n,) not at a bound
    converged: bool
    n_iterations: int
    damping: float = FIRST_DAMPING  # that its next step would have
    is_near: bool = False  # a law's slopes, and so its curvature, are those of near by
    on: tuple[Stage, tuple[int, ...]] | None = None  # where slope and curvature are those at u

    @property
    def values(self) -> dict[str, float]:
        """Return the physical value of every parameter."""
        return self.space.values(self.u)

    @property
    def title(self) -> str:
        """Return the effect it has beside the model before, in words."""
        instances = self.hypothesis.instances
        return instances[-1].title if instances else "nothing missing"

    @property
    def last(self) -> Instance:
        """Return the effect that was added last; there must be one."""
        return self.hypothesis.instances[-1]

    @property
    def ordinary_at_limit(self) -> tuple[str, ...]:
        """Return the ordinary parameters that ended as far from their means as is tried."""
        own = {name for instance in self.hypothesis.instances for name in instance.owned}
        far = np.abs(self.u) > FARTHEST - _EDGE
        return tuple(n for n, i in self.space.index.items() if far[i] and n not in own)

    @property
    def log_det(self) -> float:
        """Return ln det(data curvature + prior) / 2 over the free parameters."""
        f = self.free
        A = self.curvature[np.ix_(f, f)] + np.eye(int(f.sum()))
        return 0.5 * float(np.linalg.slogdet(A)[1])

    @property
    def evidence(self) -> float:
        """Return minus the log evidence up to a constant: cost + ln det / 2 (Laplace)."""
        return self.cost + self.log_det

    @property
    def promised(self) -> float:
        """Return how much less the cost would be where its quadratic is least, within the bounds.

        Next to nothing at a fit's end; more tells that small steps alone made it end.
        """
        A = self.curvature + np.eye(len(self.u))
        low, high = self.space.low - self.u, self.space.high - self.u
        return promise(A, self.slope, least_in_box(A, self.slope, low, high))

    def covariance(self, inflation: float = 1.0) -> Array:
        """Return (n, n) covariance in units of the priors; `inflation` of the data's variance."""
        f = self.free
        result = np.zeros_like(self.curvature)
        A = self.curvature[np.ix_(f, f)] / inflation + np.eye(int(f.sum()))
        result[np.ix_(f, f)] = np.linalg.inv(A)
        return result


def fit_hypothesis(
    stage: Stage,
    hypothesis: Hypothesis,
    *,
    start: Mapping[str, float] | None = None,
    postures: Sequence[int] | None = None,
    max_iterations: int = 12,
    tolerance: float = TOLERANCE,
    closing: bool = True,
    resumed: Fit | None = None,
    target_cost: float = -np.inf,
    is_hopeless: Callable[[Fit], bool] | None = None,
) -> Fit:
    """Fit a hypothesis to the data of one stage.

    A joint's own law that was added last is exact at every step, by slopes of near by; where these
    bring little it is linearised anew, until that is no better. One that was there before stays
    linear about where it is.

    Parameters
    ----------
    start
        Values to begin with, by name; priors' means for the others.
    postures
        Indices of the postures used; all when omitted.
    tolerance
        Stop when a step gains less than this in cost, or than a very small part of it.
    closing
        Take misfit, slope and curvature at the end; else they are those where the last step began,
        of a law those of near by: enough for a fit that only tells whether to go on.
    resumed
        A fit of the same hypothesis whose end is the start: on the same lines it need not be
        evaluated again.
    target_cost
        Cost below which no further step is made.
    is_hopeless
        Asked of the fit before each of its steps, or before a law is linearised anew: whether it
        ends there.
    """
    once = partial(
        _fit,
        stage,
        postures=postures,
        tolerance=tolerance,
        closing=closing,
        target_cost=target_cost,
    )
    if not hypothesis.has_laws:
        return once(
            hypothesis,
            start=start,
            resumed=resumed,
            max_iterations=max_iterations,
            is_hopeless=is_hopeless,
        )
    space = hypothesis.space()
    u = space.start(start) if resumed is None else resumed.u
    if hypothesis.instances[-1].law is None:
        about = linearised(hypothesis, stage.models, stage.lines, space.values(u))
        return once(about, start=space.values(u), resumed=None, max_iterations=max_iterations)

    def anew(values: Mapping[str, float]) -> Fit:
        about = linearised(hypothesis, stage.models, stage.lines, values, last=True)
        return once(about, start=values, resumed=None, max_iterations=0)

    def near(about: Fit, values: Mapping[str, float]) -> Fit | None:
        """By the slopes that are known; None where swings do not stay finite."""
        try:
            there = linearised_near(about.hypothesis, stage.models, stage.lines, values)
            return once(there, start=values, resumed=None, max_iterations=0)
        except np.linalg.LinAlgError:
            return None

    used = tuple(range(len(stage.lines))) if postures is None else tuple(postures)
    begun = resumed if resumed is not None and resumed.on == (stage, used) else None
    return _by_slopes_near(
        anew(space.values(u)) if begun is None else begun,
        anew,
        near,
        max_iterations=max_iterations,
        tolerance=tolerance,
        closing=closing,
        is_hopeless=is_hopeless,
    )


def _by_slopes_near(
    best: Fit,
    anew: Callable[[Mapping[str, float]], Fit],
    near: Callable[[Fit, Mapping[str, float]], Fit | None],
    *,
    max_iterations: int,
    tolerance: float,
    closing: bool,
    is_hopeless: Callable[[Fit], bool] | None,
) -> Fit:
    """Fit from where slopes are known, by these until they bring little.

    `anew` makes them at values, `near` keeps a fit's; None where there is no cost.
    """
    space, damping = best.space, best.damping
    is_new, converged = not best.is_near, False  # whether slopes are those there
    for _ in range(max_iterations):
        if is_hopeless is not None and is_hopeless(best):
            break
        little = max(tolerance, _PART * best.cost)
        step, promised = damped_step(space, best.u, best.slope, best.curvature, damping)
        tried = promised >= _NOTHING * little
        trial, gained = None, 0.0
        if tried:
            trial = near(best, space.values(np.clip(best.u + step, space.low, space.high)))
            gained = -np.inf if trial is None else best.cost - trial.cost
        converged = is_new and (not tried or 0.0 < gained < little)
        if tried and (is_new or gained > 0.0):
            damping = next_damping(damping, gained / promised)
        if trial is not None and gained > 0.0:
            best, is_new = trial, False
        if converged:
            break
        if gained < little and not is_new:
            best, is_new = anew(best.values), True
    if not is_new and (closing or converged):
        best, is_new = anew(best.values), True
    return replace(best, damping=damping, converged=converged, is_near=not is_new)


def _fit(
    stage: Stage,
    hypothesis: Hypothesis,
    *,
    start: Mapping[str, float] | None,
    postures: Sequence[int] | None,
    max_iterations: int,
    tolerance: float,
    closing: bool,
    resumed: Fit | None,
    target_cost: float,
    is_hopeless: Callable[[Fit], bool] | None = None,
) -> Fit:
    """Fit a hypothesis that is as linear as it gets: `fit_hypothesis`."""
    used = tuple(range(len(stage.lines))) if postures is None else tuple(postures)
    space = hypothesis.space()
    u = space.start(start) if resumed is None else resumed.u
    damping = FIRST_DAMPING
    if resumed is not None and resumed.on is not None and resumed.on == (stage, used):
        misfit, damping = resumed.misfit, resumed.damping
        now = Quadratic(cost=sum(misfit), gradient=resumed.slope - u, curvature=resumed.curvature)
    else:
        now, misfit = stage.whole_quadratic(hypothesis, space, space.values(u), used)
    cost = now.cost + 0.5 * float(u @ u)
    converged = False
    iteration = 0
    moved = False

    def reached() -> Fit:
        slope = now.gradient + u
        return Fit(
            hypothesis=hypothesis,
            space=space,
            u=u,
            cost=cost,
            misfit=misfit,
            curvature=now.curvature,
            slope=slope,
            free=~_resting(space, u, slope),
            converged=converged,
            n_iterations=iteration,
            damping=damping,
            on=None if moved else (stage, used),
        )

    while iteration < max_iterations and cost >= target_cost:
        if moved:
            now, misfit = stage.whole_quadratic(hypothesis, space, space.values(u), used)
            moved = False
        if is_hopeless is not None and is_hopeless(reached()):
            break
        iteration += 1
        slope = now.gradient + u
        gained = 0.0
        for _ in range(_TRIALS):
            step, promised = damped_step(space, u, slope, now.curvature, damping)
            if promised < _NOTHING * max(tolerance, _PART * cost):
                break
            trial = np.clip(u + step, space.low, space.high)
            trial_cost = cost_of(stage, hypothesis, space, trial, used)
            kept = (cost - trial_cost) / promised
            damping = next_damping(damping, kept)
            if kept > 0.0:
                gained, moved = cost - trial_cost, True
                u, cost = trial, trial_cost
                break
        if gained < max(tolerance, _PART * cost):
            converged = True
            break
    if moved and closing:
        now, misfit = stage.whole_quadratic(hypothesis, space, space.values(u), used)
        moved = False
    return reached()


def best_starting_point(
    stage: Stage, hypothesis: Hypothesis, starting_points: Sequence[Mapping[str, float]]
) -> Mapping[str, float]:
    """Return the start of least cost."""
    return min(starting_points, key=lambda start: cost_at(stage, hypothesis, start))


def cost_at(stage: Stage, hypothesis: Hypothesis, start: Mapping[str, float]) -> float:
    """Return the cost where a fit to all postures would begin; infinite where there is none."""
    space = hypothesis.space()
    u = space.start(start)
    if hypothesis.has_laws:
        is_last = hypothesis.instances[-1].law is not None
        try:
            hypothesis = linearised(
                hypothesis, stage.models, stage.lines, space.values(u), last=is_last, slopes=False
            )
        except np.linalg.LinAlgError:
            return float("inf")
    return cost_of(stage, hypothesis, space, u, range(len(stage.lines)))


def cost_of(
    stage: Stage, hypothesis: Hypothesis, space: Space, u: Array, postures: Sequence[int]
) -> float:
    """Return the cost at a vector (n,) of the space, laws as they are known.

    Infinite where there is none.
    """
    try:
        misfit = sum(stage.misfit(hypothesis, space.values(u), postures))
    except np.linalg.LinAlgError:
        return float("inf")
    return misfit + 0.5 * float(u @ u)


def _resting(space: Space, u: Array, slope: Array) -> npt.NDArray[np.bool_]:
    low = (u <= space.low + _EDGE) & (slope > 0.0)
    high = (u >= space.high - _EDGE) & (slope < 0.0)
    return np.asarray(low | high)
