"""Fit of one hypothesis by Levenberg's steps, its priors and bounds included.

Vectors count prior standard deviations, so the prior's curvature is the identity. At a bound a
parameter whose slope points outward rests.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.box import least_in_box
from armodal.analyzer.gap.inference.levenberg import (
    FIRST_DAMPING,
    damped_step,
    next_damping,
    promise,
)
from armodal.analyzer.gap.model.assembly import BASE
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.linearised import linearised
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.mounting_errors import mounting_error_columns
from armodal.analyzer.gap.model.posed import PosedModel, Postures
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.weigh import Discrepancy, Quadratic, Weighing, costs_of, summed

__all__ = [
    "TOLERANCE",
    "Fit",
    "Stage",
    "as_at_the_middle",
    "better_start",
    "cost_at",
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
_LAW_ROUNDS = 6  # of joints' laws linearised anew
_TO_THE_MIDDLE = 2  # a law is of its joint's spring, which then is another
_PARTS_OF_A_STEP = (1.0, 0.3, 0.1)  # of what a linear law foretells to be best
_TOGETHER = 320  # lines of postures solved together: more outgrow the processor's cache


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """A hypothesis at its best point."""

    hypothesis: Hypothesis
    space: Space
    u: Array  # (n,)
    cost: float  # chi^2 / 2 + prior
    first_cost: float  # where the fit began
    misfit: tuple[float, ...]  # chi^2 / 2 of each posture used
    curvature: Array  # (n, n) of the data at u
    slope: Array  # (n,) of the cost; not zero at bounds
    free: npt.NDArray[np.bool_]  # (n,) not at a bound
    converged: bool
    n_iterations: int
    damping: float = FIRST_DAMPING  # that its next step would have
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
    def farthest(self) -> float:
        """Return how far any ordinary parameter is from its prior's mean, in prior deviations."""
        own = {name for instance in self.hypothesis.instances for name in instance.owned}
        ordinary = [i for name, i in self.space.index.items() if name not in own]
        return float(np.max(np.abs(self.u[ordinary])))

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


class Stage:
    """The data of one annealing stage, ready to be fitted by any hypothesis."""

    def __init__(
        self,
        superset: Superset,
        lines: Sequence[PostureLines],
        discrepancy: Discrepancy,
        *,
        models: Sequence[PosedModel] | None = None,
        places: Sequence[ComplexArray] | None = None,
    ) -> None:
        self.lines = tuple(lines)
        self.models = tuple(models or models_of(superset, self.lines))
        self._superset, self._discrepancy = superset, discrepancy
        self.weighings = tuple(
            Weighing(
                own,
                superset.arm.tolerances,
                discrepancy,
                places=of,
                on_base=np.array(superset.point_link)[own.sensor_point] == BASE,
            )
            for own, of in zip_longest(self.lines, places or ())
        )
        self._first_of = _firsts(self.lines, self.models)
        self._groups: dict[tuple[int, ...], list[tuple[list[int], Postures]]] = {}

    def with_places(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> Stage:
        """Return the stage with what single mountings' places and hits' aims may be off.

        `values` are near enough for what such small errors change.
        """
        places: list[ComplexArray] = [np.zeros((), dtype=np.complex128)] * len(self.lines)
        for rows, together in self.once(hypothesis, range(len(self.lines))):
            found = mounting_error_columns(
                together.response(hypothesis, values), self._superset.arm.tolerances
            )
            for p, i in rows:
                places[p] = found[i]
        return Stage(
            self._superset, self.lines, self._discrepancy, models=self.models, places=places
        )

    def together(self, postures: Sequence[int] | None = None) -> list[tuple[list[int], Postures]]:
        """Return postures, all if none are given, in groups that are solved together."""
        used = tuple(range(len(self.lines)) if postures is None else postures)
        if used not in self._groups:
            alike: dict[tuple[object, ...], list[int]] = {}
            for p in used:
                alike.setdefault(Postures.likeness(self.lines[p]), []).append(p)
            groups = []
            for all_alike in alike.values():
                most = max(_TOGETHER // self.lines[all_alike[0]].s_rad_s.size, 1)
                groups += [all_alike[i : i + most] for i in range(0, len(all_alike), most)]
            self._groups[used] = [
                (own, Postures([self.models[p] for p in own], [self.lines[p] for p in own]))
                for own in groups
            ]
        return self._groups[used]

    def misfit(
        self, hypothesis: Hypothesis, values: Mapping[str, float], postures: Sequence[int]
    ) -> list[float]:
        """chi^2 / 2 of each posture; infinite where a response outgrows the arithmetic."""
        cost_of: dict[int, float] = {}
        for rows, together in self.once(hypothesis, postures):
            y = together.response(hypothesis, values).values
            own, at = zip(*rows, strict=True)
            costs = costs_of([self.weighings[p] for p in own], y[list(at)])
            cost_of |= dict(zip(own, costs, strict=True))
        return [cost_of[p] if cost_of[p] >= 0.0 else float("inf") for p in postures]

    def quadratics(
        self,
        hypothesis: Hypothesis,
        space: Space,
        values: Mapping[str, float],
        postures: Sequence[int],
    ) -> list[Quadratic]:
        """Misfit, gradient and curvature of each posture."""
        found: dict[int, Quadratic] = {}
        for rows, together in self.once(hypothesis, postures):
            y, columns = together.columns(hypothesis, space, values)
            for p, i in rows:
                found[p], _ = summed([self.weighings[p]], y[[i]], columns.of_posture(i), [0])
        return [found[p] for p in postures]

    def whole_quadratic(
        self,
        hypothesis: Hypothesis,
        space: Space,
        values: Mapping[str, float],
        postures: Sequence[int],
    ) -> tuple[Quadratic, tuple[float, ...]]:
        """Misfit, gradient and curvature of postures together, and the misfit of each."""
        gradient = np.zeros(len(space))
        curvature = np.zeros((len(space), len(space)))
        cost_of: dict[int, float] = {}
        for rows, together in self.once(hypothesis, postures):
            y, columns = together.columns(hypothesis, space, values)
            own, at = zip(*rows, strict=True)
            part, costs = summed([self.weighings[p] for p in own], y, columns, at)
            gradient += part.gradient
            curvature += part.curvature
            cost_of |= dict(zip(own, costs, strict=True))
        each = tuple(cost_of[p] for p in postures)
        return Quadratic(cost=sum(each), gradient=gradient, curvature=curvature), each

    def once(
        self, hypothesis: Hypothesis, postures: Sequence[int]
    ) -> Iterator[tuple[list[tuple[int, int]], Postures]]:
        """Give what is solved together, and which row of it each posture has.

        Soft and hard hits of a posture share one while nothing follows the level.
        """
        first_of = range(len(self.lines)) if hypothesis.level_dependent else self._first_of
        for own, together in self.together(tuple(dict.fromkeys(first_of[p] for p in postures))):
            yield [(p, own.index(first_of[p])) for p in postures if first_of[p] in own], together


def models_of(superset: Superset, lines: Sequence[PostureLines]) -> list[PosedModel]:
    """Return a model for each of the lines; soft and hard hits of a posture share one."""
    models: dict[tuple[float, ...], PosedModel] = {}
    found = []
    for own in lines:
        angles = tuple(own.joints_rad.tolist())
        if angles not in models:
            models[angles] = PosedModel(superset, own.joints_rad)
        found.append(models[angles])
    return found


def _firsts(lines: Sequence[PostureLines], models: Sequence[PosedModel]) -> list[int]:
    """For each the first that every model without the level answers alike."""
    firsts: list[int] = []
    for p, own in enumerate(lines):
        alike = (
            q for q in dict.fromkeys(firsts) if models[q] is models[p] and lines[q].is_hit_as(own)
        )
        firsts.append(next(alike, p))
    return firsts


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
    enough: float = -np.inf,
) -> Fit:
    """Fit a hypothesis to the data of one stage.

    A joint's own law that was added last is linearised anew about every end, until that is no
    better; one that was there before stays linear about where it is.

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
        enough for a fit that only tells by its cost whether to go on.
    resumed
        A fit of the same hypothesis whose end is the start: on the same lines it need not be
        evaluated again.
    enough
        Cost below which no further step is made.
    """
    once = partial(
        _fit, stage, postures=postures, tolerance=tolerance, closing=closing, enough=enough
    )
    if not hypothesis.has_laws:
        return once(hypothesis, start=start, resumed=resumed, max_iterations=max_iterations)
    space = hypothesis.space()
    u = space.start(start) if resumed is None else resumed.u
    if hypothesis.instances[-1].law is None:
        about = linearised(hypothesis, stage.models, stage.lines, space.values(u))
        return once(about, start=space.values(u), resumed=None, max_iterations=max_iterations)

    def at(values: Mapping[str, float]) -> Fit:
        about = linearised(hypothesis, stage.models, stage.lines, values, last=True)
        return once(about, start=values, resumed=None, max_iterations=0)

    best = at(space.values(u))
    for _ in range(_LAW_ROUNDS if max_iterations else 0):
        end = once(
            best.hypothesis, start=best.values, resumed=None, max_iterations=max_iterations
        ).values
        there = best
        for part in _PARTS_OF_A_STEP:
            there = at({n: best.values[n] + part * (end[n] - best.values[n]) for n in end})
            if there.cost < best.cost:
                break
        gained = best.cost - there.cost
        best = there if gained > 0.0 else best
        if gained < max(tolerance, _PART * best.cost):
            return replace(best, converged=True)
    return best


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
    enough: float,
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
    cost = first_cost = now.cost + 0.5 * float(u @ u)
    converged = False
    iteration = 0
    moved = False
    while iteration < max_iterations and cost >= enough:
        iteration += 1
        if moved:
            now, misfit = stage.whole_quadratic(hypothesis, space, space.values(u), used)
            moved = False
        slope = now.gradient + u
        gained = 0.0
        for _ in range(_TRIALS):
            step, promised = damped_step(space, u, slope, now.curvature, damping)
            if promised < _NOTHING * max(tolerance, _PART * cost):
                break
            trial = np.clip(u + step, space.low, space.high)
            trial_cost = _cost(stage, hypothesis, space, trial, used)
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
    slope = now.gradient + u
    return Fit(
        hypothesis=hypothesis,
        space=space,
        u=u,
        cost=cost,
        first_cost=first_cost,
        misfit=misfit,
        curvature=now.curvature,
        slope=slope,
        free=~_resting(space, u, slope),
        converged=converged,
        n_iterations=iteration,
        damping=damping,
        on=None if moved else (stage, used),
    )


def better_start(
    stage: Stage, hypothesis: Hypothesis, starts: Sequence[Mapping[str, float]]
) -> Mapping[str, float]:
    """Return the start of least cost."""
    return min(starts, key=lambda start: cost_at(stage, hypothesis, start))


def as_at_the_middle(
    stage: Stage, hypothesis: Hypothesis, start: Mapping[str, float]
) -> dict[str, float]:
    """Values with the joint's spring and damper such that, with its law, they stay what they were.

    On average over all postures and levels. The law is the last instance's.
    """
    space, law = hypothesis.space(), hypothesis.instances[-1].law
    values = space.values(space.start(start))
    if law is None:
        return values
    names = [f"ln {what} {law.joint}" for what in "kc"]
    wanted = np.array([values[name] for name in names])
    for _ in range(_TO_THE_MIDDLE):
        about = linearised(hypothesis, stage.models, stage.lines, values, last=True, slopes=False)
        with_law = [about.instances[-1].linear_law(own) for own in stage.lines]
        added = np.mean([(own.log_k, own.log_c) for own in with_law if own is not None], axis=0)
        values |= dict(zip(names, (wanted - added).tolist(), strict=True))
    return space.values(space.start(values))


def cost_at(stage: Stage, hypothesis: Hypothesis, start: Mapping[str, float]) -> float:
    """Return the cost where a fit to all postures would begin; infinite where there is none."""
    space = hypothesis.space()
    u = space.start(start)
    if hypothesis.has_laws:
        is_last = hypothesis.instances[-1].law is not None
        hypothesis = linearised(
            hypothesis, stage.models, stage.lines, space.values(u), last=is_last, slopes=False
        )
    return _cost(stage, hypothesis, space, u, range(len(stage.lines)))


def _cost(
    stage: Stage, hypothesis: Hypothesis, space: Space, u: Array, postures: Sequence[int]
) -> float:
    """Cost at a point; infinite where there is none."""
    try:
        misfit = sum(stage.misfit(hypothesis, space.values(u), postures))
    except np.linalg.LinAlgError:
        return float("inf")
    return misfit + 0.5 * float(u @ u)


def _resting(space: Space, u: Array, slope: Array) -> npt.NDArray[np.bool_]:
    low = (u <= space.low + _EDGE) & (slope > 0.0)
    high = (u >= space.high - _EDGE) & (slope < 0.0)
    return np.asarray(low | high)
