"""Rivals for what the present hypothesis does not explain: all looked at, the best fitted sharply.

Where the present hypothesis comes near the measurement, a linear look at all effects on the sharp
lines tells which deserve a fit. Where it does not, that look misleads, and the search anneals: the
most promising effects are fitted on broad lines first, the best of those on sharper ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from analyzer.gap.fit import Fit, Stage, fit_hypothesis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.looks import look_at_all, most_promising
from analyzer.gap.starts import (
    BEHIND,
    FIRST_STEPS,
    WORTH_BROAD,
    axes_of_bearings,
    behind_joints,
    first_steps,
    from_the_start,
    not_hopeless,
    split_axes,
)

__all__ = ["Rivals", "find_rivals"]

_MOST_PROMISING = 4
_COARSE, _MIDDLE, _FINALISTS = 9, 4, 4
_LOOKED_AT_SHARPLY = 10
_BEHIND_BROADLY = 1.5  # times the least cost on broad lines, likewise
_OBVIOUS = 0.3  # of the plain fit's cost on the widest: what costs less needs no other look
_LEAP, _MOST_LEAPS = 0.7, 4  # of the cost; rounds
_SPLIT = 2  # leading fits in which an axis may have a part of its link before it
_NEAR = 0.9  # misfit a residual below which a linear look on the sharp lines is trusted
_BELIEVABLE = (
    4.9  # prior deviations: beyond, at the limits of what is ordinary, the fit went astray
)
# Where soft and hard hits are told apart: a joint that follows the level leaves much, and is near.
_NEAR_BY_LEVEL = 4.0
_WORTH_SHARP = 15.0  # of cost by the linear look; less is not worth a fit
# Evidence behind the best at which a rival is dropped: sharper lines weigh some five times more.
_HOPELESS = 400.0
_LITTLE = 8.0  # of evidence after two steps: less becomes no name
_PROMISE = 1.0  # of evidence over the present hypothesis, to be fitted on sharper lines
_STEPS = 24  # a finalist converges within these

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivals:
    """The hypothesis so far and its rivals on the sharp lines, best evidence first."""

    present: Fit
    rivals: tuple[Fit, ...]


def find_rivals(
    stages: Sequence[Stage],
    present: Hypothesis,
    *,
    postures: Sequence[int] | None = None,
    start: dict[str, float] | None = None,
    tell: Progress = lambda _: None,
) -> Rivals:
    """Fit the present hypothesis and the effects that could improve on it.

    Parameters
    ----------
    stages
        Widest, broad, middle and sharp lines of the same postures.
    """
    widest, broad, middle, sharp = stages
    tell("the arm as believed" if not present.instances else present.name)
    at_widest = fit_hypothesis(widest, present, start=start, postures=postures, max_iterations=7)
    base = _further(broad, at_widest, postures, 5)
    at_middle = _further(middle, base, postures, 5)
    at_sharp = _further(sharp, at_middle, postures, 8)
    per_line = 2.0 * at_sharp.cost / sum(w.n for w in sharp.weighings)
    near = _NEAR_BY_LEVEL if present.ordinary.level_span else _NEAR
    lost = at_sharp.farthest > _BELIEVABLE
    if per_line < near and not lost:
        least = base.cost
        at_sharp = _further(sharp, at_sharp, postures, _STEPS)
        looked_at = look_at_all(sharp, at_sharp, start or {}, from_start=False)
        chosen = most_promising(looked_at, _WORTH_SHARP, each_kind=False)[:_LOOKED_AT_SHARPLY]
        first = first_steps(sharp, at_sharp, chosen, postures, start or {})
        # The best after two steps, and those that promise most: some need more than two.
        promising = [c.instance.key for c in looked_at[:_MOST_PROMISING]]
        best = _leading(first, None)[: _FINALISTS - 1]
        best += [f for f in first if _key(f) in promising and _key(f) not in map(_key, best)][:2]
        little = at_sharp.evidence - _LITTLE
        best = [f for i, f in enumerate(best) if i == 0 or f.evidence < little]
    else:
        wide = from_the_start(widest, present, postures, start or {}, alone=lost)
        coarse = [_further(broad, f, postures, FIRST_STEPS) for f in not_hopeless(wide, BEHIND)]
        if not lost and wide[0].cost > _OBVIOUS * at_widest.cost:
            looked_at = look_at_all(broad, base, start or {}, from_start=True)
            chosen = most_promising(looked_at, WORTH_BROAD, each_kind=True)
            coarse += first_steps(broad, base, chosen, postures, start or {})
        coarse.sort(key=lambda f: f.cost)
        leading = not_hopeless(coarse, _BEHIND_BROADLY)[:_COARSE]
        coarse += axes_of_bearings(broad, present, leading, postures)
        coarse.sort(key=lambda f: f.cost)
        best = []
        for f in not_hopeless(coarse, _BEHIND_BROADLY)[:_COARSE]:
            tell(f.hypothesis.name)
            best.append(_further(broad, f, postures, 6))
        least = min(f.cost for f in best)
        best += split_axes(broad, _leading(best, base)[:_SPLIT], postures, 6)
        best = [_further(middle, f, postures, 5) for f in _leading(best, base)[:_MIDDLE]]
        best = _leading(best, at_middle)
    behind = behind_joints(broad, base, postures)
    behind = [f for f in _leading(behind, base)[:1] if f.cost < BEHIND * least]
    best += [f for f in behind if _key(f) not in map(_key, best)]
    finals = []
    for f in best[: _FINALISTS + 2]:
        tell(f"sharply: {f.hypothesis.name}")
        finals.append(_further(sharp, f, postures, 8))
    finals.sort(key=lambda f: f.evidence)
    finals += split_axes(sharp, finals[:1], postures, 8)
    finals = _leading(finals, None)
    finals = [
        f if f.converged else _further(sharp, f, postures, _STEPS)
        for f in finals
        if f.evidence < finals[0].evidence + _HOPELESS
    ]
    return Rivals(
        present=at_sharp,
        rivals=tuple(sorted(finals, key=lambda f: f.evidence)),
    )


def _key(fit: Fit) -> tuple[str, str]:
    return fit.hypothesis.instances[-1].key


def _further(stage: Stage, fit: Fit, postures: Sequence[int] | None, steps: int) -> Fit:
    """Some steps more; and again while the cost still falls by leaps."""
    if fit.converged and fit.on is not None and fit.on[0] is stage:
        return fit
    for _ in range(_MOST_LEAPS):
        further = fit_hypothesis(
            stage, fit.hypothesis, resumed=fit, postures=postures, max_iterations=steps
        )
        leapt = further.n_iterations == steps and further.cost < _LEAP * further.first_cost
        fit = further
        if not leapt:
            break
    return fit


def _leading(fits: Sequence[Fit], base: Fit | None) -> list[Fit]:
    """By evidence; one for each effect and place, and none hopeless beside the best or the base."""
    if not fits:
        return []
    kept: dict[tuple[tuple[str, str], ...], Fit] = {}
    for fit in sorted(fits, key=lambda f: f.evidence):
        kept.setdefault(tuple(i.key for i in fit.hypothesis.instances), fit)
    ordered = list(kept.values())
    worst = ordered[0].evidence + _HOPELESS
    if base is not None:
        worst = min(worst, base.evidence - _PROMISE)
    return [f for f in ordered if f.evidence < worst]
