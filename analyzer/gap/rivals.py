"""Rivals for what the present hypothesis does not explain: all looked at, the best fitted sharply.

Where the present hypothesis comes near the measurement, a linear look at all effects on the sharp
lines tells which deserve a fit. Where it does not, that look misleads, and the search anneals: the
most promising effects are fitted on broad lines first, the best of those on sharper ones. Where it
comes near only with an ordinary error at its limit, both are done: what only the sharp lines show,
such as a window nobody took off, no broad ones tell.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from armodal.analyzer.gap.by_level import promising_by_level
from armodal.analyzer.gap.effects.effect import Instance
from armodal.analyzer.gap.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.judge import is_plainer, misfit_per_line
from armodal.analyzer.gap.looks import look_at_all, look_at_others, most_promising
from armodal.analyzer.gap.other_ends import other_ends
from armodal.analyzer.gap.scan import Candidate
from armodal.analyzer.gap.starts import (
    BEHIND,
    FIRST_STEPS,
    WORTH_BROAD,
    axes_of_bearings,
    bearings_of_axes,
    behind_joints,
    every_bearing,
    first_steps,
    from_the_start,
    not_hopeless,
    split_axes,
    spread_axes,
)

__all__ = ["Rivals", "find_rivals"]

_MOST_PROMISING = 4
_MIDDLE, _FINALISTS = 4, 4
# Fits on broad lines, some steps each in turn; about a fit with a name the cost tells more.
_COARSE, _COARSE_AGAIN, _FEWEST = (9, 5), (6, 3), (3, 1)  # the last where they explain little
_FEW, _TOLD_BROADLY = 4, 0.9  # where the broad lines leave no more misfit a residual than this
_LOOKED_AT_SHARPLY, _LOOKED_AT_BROADLY = 8, 14
# Times the least cost on broad lines, at first, later, and for the few that lead.
_BEHIND_BROADLY, _BEHIND_LATER, _FEW_BEHIND = 1.5, 1.3, 2.0
_MUCH, _PART_OF_GAIN = 400.0, 0.3  # of cost on broad lines; what brings less than a part is not it
_A_LITTLE = 0.15  # likewise
_AHEAD = 0.97  # times the least cost of others on broad lines
_SEEN = 0.5  # of cost on the widest lines: a servo that brings less is not there
_LARGE_PART = 0.4  # likewise, of evidence, to be fitted on sharper lines
_OBVIOUS = 0.3  # of the plain fit's cost on the widest: what costs less needs no other look
_BLIND = 0.95  # likewise: if nothing costs less, the widest lines tell next to nothing
_LEAP, _MOST_LEAPS = 0.7, 4  # of the cost; rounds
_SPLIT = 2  # leading fits in which an axis may have a part of its link before it
_NEAR = 0.9  # misfit a residual below which a linear look on the sharp lines is trusted
# Prior deviations: beyond, at the limits of what is ordinary, the fit went astray.
_BELIEVABLE = 4.9
# Where soft and hard hits are told apart: a joint that follows the level leaves much, and is near.
_NEAR_BY_LEVEL = 4.0
# Of cost by the linear look, for a term of the equations and for an error of the measurement: less
# is not worth a fit.
_WORTH_SHARP, _WORTH_ERROR = 22.0, 15.0
_SOMETHING = 60.0  # of evidence: more is there than chance
_WORTH_SPLIT = 50.0  # of evidence: an axis that brings less becomes no name with a part before it
_FIRST_SHARPLY, _BLOCK = 9, 3  # steps of a finalist, how many at a time
# A finalist goes on while it is no further behind than this, times misfit a residual, and than it
# would gain in so many blocks like its last, and while a block gains some part of its cost.
_BESIDE, _PATIENCE, _NOTHING = 60.0, 3.0, 1e-4
_WORTH_ALL_STEPS = 1.2  # misfit a residual above which more must be missing: it is fitted again
# Evidence behind the best at which a rival is dropped: sharper lines weigh some five times more.
_HOPELESS = 400.0
_LITTLE, _LITTLE_OF_TERM = 8.0, 16.0  # of evidence after two steps: less becomes no name
_PROMISE = 1.0  # of evidence over the present hypothesis, to be fitted on sharper lines
_ROUGHLY = 4  # steps of the present hypothesis on the sharp lines; twice where it comes near
_STEPS = 24  # a finalist converges within these

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivals:
    """The hypothesis so far and its rivals on the sharp lines, best evidence first."""

    present: Fit
    rivals: tuple[Fit, ...]
    others: tuple[Candidate, ...] | None = None  # all effects by a linear look about the present

    def with_standing(self, standing: Sequence[Fit]) -> tuple[Fit, ...]:
        """The rivals and those that stand though no search led to them; best evidence first.

        Judging may set one effect beside its twin of another file, such as softening beside
        microslip.
        """
        size = len(self.present.hypothesis.instances)
        more = [
            fit
            for fit in standing
            if len(fit.hypothesis.instances) > size
            and all(fit is not other for other in self.rivals)
        ]
        return tuple(sorted([*self.rivals, *more], key=lambda fit: fit.evidence))


def find_rivals(
    stages: Sequence[Stage],
    present: Hypothesis,
    *,
    start: dict[str, float] | None = None,
    fitted: Fit | None = None,
    tell: Progress = lambda _: None,
) -> Rivals:
    """Fit the present hypothesis and the effects that could improve on it.

    Parameters
    ----------
    stages
        Widest, broad, middle and sharp lines of the same postures.
    fitted
        A sharp fit of the present hypothesis to all postures, if there is one.
    """
    widest, broad, middle, sharp = stages
    start = start or {}
    tell("the arm as believed" if not present.instances else present.name)
    so_far = _annealed(stages, present, start, fitted)
    others: list[Candidate] | None = None
    looked: list[Fit] = []
    searched: list[Fit] = []
    least = so_far.widest.cost, so_far.broad.cost
    if so_far.near:
        so_far = replace(so_far, sharp=_further(sharp, so_far.sharp, _STEPS))
        others = look_at_others(sharp, so_far.sharp)
        looked = _looked_for(sharp, so_far.sharp, start, others)
    if so_far.astray:
        searched, least = _searched(stages, so_far, start, tell)
    keys = [_key(f) for f in looked]
    best = [*looked, *(f for f in searched if _key(f) not in keys)]
    most = _FINALISTS + 2 + (len(looked) if searched else 0)
    servos = _behind_joints(widest, broad, so_far, least)
    lines, steps = (middle, 5) if so_far.astray else (sharp, FIRST_STEPS)  # as the others had
    best = _with(best, [_further(lines, f, steps) for f in servos])
    finals: list[Fit] = []
    for f in best[:most]:
        tell(f"sharply: {f.hypothesis.name}")
        finals.append(_while_hopeful(sharp, f, finals, _FIRST_SHARPLY))
    finals.sort(key=lambda f: f.evidence)
    worth_splits = bool(finals) and so_far.sharp.evidence - finals[0].evidence > _WORTH_SPLIT
    if worth_splits and not so_far.astray:  # else they were tried on the broad lines
        finals += split_axes(sharp, finals[:1], 8)
    if worth_splits:
        finals += spread_axes(sharp, finals[:1], 8)
    plainer = [f for f in finals[1:] if is_plainer(finals[0], f)]  # judged beside it
    finals = _leading(finals, None)
    finals += [f for f in plainer if all(f is not other for other in finals)]
    if finals and misfit_per_line(sharp, finals[0]) < _WORTH_ALL_STEPS:
        finals[0] = _while_hopeful(sharp, finals[0], (), _STEPS)
        finals[1:] = [_while_hopeful(sharp, f, finals, _STEPS) for f in finals[1:]]
    return Rivals(
        present=so_far.sharp,
        rivals=tuple(sorted(finals, key=lambda f: f.evidence)),
        others=None if others is None else tuple(others),
    )


def _behind_joints(
    widest: Stage, broad: Stage, so_far: _Annealed, least: tuple[float, float]
) -> list[Fit]:
    """The best servo, if it is not far behind the least costs on the widest and broad lines.

    Where after a name much is left it must explain a part of that, or more than all others do.
    """
    worth = min(BEHIND * least[0], so_far.widest.cost - _SEEN)
    servos = [_further(broad, f, 3) for f in behind_joints(widest, so_far.widest, worth)]
    worth = BEHIND * least[1]
    if so_far.far_off:
        worth = min(worth, max((1.0 - _A_LITTLE) * so_far.broad.cost, _AHEAD * least[1]))
    return [f for f in _leading(servos, so_far.broad)[:1] if f.cost < worth]


def _with(fits: Sequence[Fit], more: Sequence[Fit]) -> list[Fit]:
    """Fits with more on the same lines: where both have an effect and place what costs less."""
    kept = {_key(f): f for f in fits}
    for f in more:
        known = kept.get(_key(f))
        if known is None or f.cost < known.cost:
            kept[_key(f)] = f
    return list(kept.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class _Annealed:
    """The present hypothesis on the lines of each stage."""

    widest: Fit
    broad: Fit
    middle: Fit
    sharp: Fit
    near: bool  # the measurement: a linear look on the sharp lines may be trusted
    astray: bool  # not near, or where nothing is believable
    again: bool  # something was named already
    far_off: bool  # likewise, and much is left


def _annealed(
    stages: Sequence[Stage],
    present: Hypothesis,
    start: dict[str, float],
    fitted: Fit | None,
) -> _Annealed:
    widest, broad, middle, sharp = stages
    if fitted is None:
        at_widest = fit_hypothesis(widest, present, start=start, max_iterations=7)
        at_broad = _further(broad, at_widest, 5)
        at_middle = _further(middle, at_broad, 5)
        at_sharp = _further(sharp, at_middle, _ROUGHLY)
        if misfit_per_line(sharp, at_sharp) < _WORTH_ALL_STEPS:
            at_sharp = _further(sharp, at_sharp, _ROUGHLY)
    else:
        at_widest = fit_hypothesis(widest, present, resumed=fitted, max_iterations=4)
        at_broad = _further(broad, at_widest, 3)
        at_middle, at_sharp = _further(middle, at_broad, 1), fitted
    is_near = _is_near(sharp, at_sharp)
    return _Annealed(
        widest=at_widest,
        broad=at_broad,
        middle=at_middle,
        sharp=at_sharp,
        near=is_near,
        astray=not is_near or at_sharp.farthest > _BELIEVABLE,
        again=fitted is not None,
        far_off=fitted is not None and misfit_per_line(sharp, at_sharp) > _WORTH_ALL_STEPS,
    )


def _looked_for(
    sharp: Stage, fit: Fit, start: dict[str, float], others: Sequence[Candidate]
) -> list[Fit]:
    """By a linear look on the sharp lines."""
    looked_at = look_at_all(sharp, fit, start, from_start=False, others=others)
    worthy = [c for c in looked_at if c.gain > _WORTH_SHARP or not _is_a_term(c.instance)]
    chosen = most_promising(worthy, _WORTH_ERROR, each_kind=False)[:_LOOKED_AT_SHARPLY]
    first = first_steps(sharp, fit, chosen, start)
    if first and fit.evidence - first[0].evidence > _SOMETHING:
        first += every_bearing(sharp, fit, [_key(f) for f in first])
        first.sort(key=lambda f: f.cost)
    # The best after two steps, and those that promise most: some need more than two.
    promising = [c.instance.key for c in looked_at[:_MOST_PROMISING]]
    best = _leading(first, None)[: _FINALISTS - 1]
    best += [f for f in first if _key(f) in promising and _key(f) not in map(_key, best)][:2]
    return [f for i, f in enumerate(best) if i == 0 or fit.evidence - f.evidence > _little(f)]


def _is_a_term(instance: Instance) -> bool:
    """Whether it adds a term, which takes more to be named than an error of the measurement."""
    return instance.adds_term


def _little(fit: Fit) -> float:
    return _LITTLE_OF_TERM if _is_a_term(fit.last) else _LITTLE


def _searched(
    stages: Sequence[Stage],
    so_far: _Annealed,
    start: dict[str, float],
    tell: Progress,
) -> tuple[list[Fit], tuple[float, float]]:
    """By fits on ever sharper lines; and the least cost on the widest and on the broad ones.

    Where after a name nothing explains more than a little of much that is left, the library hardly
    knows it, and only the best is fitted further.
    """
    widest, broad, middle, _ = stages
    present, base = so_far.sharp.hypothesis, so_far.broad
    # What only the sharp lines show, such as a hose that swings, no broad ones tell apart.
    tells = misfit_per_line(broad, base) > _TOLD_BROADLY
    lost = so_far.sharp.farthest > _BELIEVABLE
    plain_cost = so_far.widest.cost
    begin = so_far.widest.values if so_far.again else start
    wide = from_the_start(
        widest,
        present,
        begin,
        alone=lost,
        again=so_far.again,
        plain_cost=plain_cost,
    )
    coarse = [_further(broad, f, FIRST_STEPS) for f in not_hopeless(wide, BEHIND)]
    least_wide = wide[0].cost if wide else plain_cost
    is_obvious = least_wide < _OBVIOUS * plain_cost
    is_blind = least_wide > _BLIND * plain_cost
    if is_blind or not (lost or so_far.again or is_obvious):
        looked_at = look_at_all(broad, base, start, from_start=True)
        chosen = most_promising(looked_at, WORTH_BROAD, each_kind=True)
        chosen = chosen[: _LOOKED_AT_BROADLY if tells else _FEW]
        coarse += first_steps(broad, base, chosen, start)
    if not coarse:
        return [], (least_wide, base.cost)
    coarse.sort(key=lambda f: f.cost)
    each = (_FEW, _FEW) if not tells else _COARSE_AGAIN if so_far.again else _COARSE
    if so_far.far_off and base.cost - coarse[0].cost < _A_LITTLE * base.cost:
        each = _FEWEST
    leading = not_hopeless(coarse, _BEHIND_BROADLY, _FEW_BEHIND)[: each[0]]
    coarse += axes_of_bearings(broad, present, leading)
    coarse.sort(key=lambda f: f.cost)
    best = not_hopeless(coarse, _BEHIND_BROADLY, _FEW_BEHIND)
    for most in each:
        tell(best[0].hypothesis.name)
        best = sorted((_further(broad, f, 3) for f in best[:most]), key=lambda f: f.cost)
        gained = base.cost - best[0].cost
        worth = base.cost - _PART_OF_GAIN * gained if gained > _MUCH else np.inf
        best = [f for f in not_hopeless(best, _BEHIND_LATER, _FEW_BEHIND) if f.cost < worth]
    least = least_wide, best[0].cost
    if so_far.far_off and base.cost - best[0].cost < _A_LITTLE * base.cost:
        return [_further(middle, best[0], 5)], least
    best += bearings_of_axes(broad, present, best[:2])
    best.sort(key=lambda f: f.cost)
    best += split_axes(broad, _leading(best, base)[:_SPLIT], 6)
    best += other_ends(broad, _leading(best, base)[:1], 9)
    by_level = [_further(broad, f, 6) for f in promising_by_level(broad, base, start)]
    best = _with(_leading(best, base)[:_MIDDLE], by_level)
    best = [_further(middle, f, 5) for f in best]
    return _leading(best, so_far.middle), least


def _is_near(sharp: Stage, fit: Fit) -> bool:
    near = _NEAR_BY_LEVEL if fit.hypothesis.ordinary.level_span else _NEAR
    return misfit_per_line(sharp, fit) < near


def _while_hopeful(stage: Stage, fit: Fit, others: Sequence[Fit], steps: int) -> Fit:
    """Some steps more at a time, while they could still bring a fit beside the best of others."""
    best = min((f.evidence for f in others if f is not fit), default=np.inf)
    allowed = _BESIDE * max(1.0, misfit_per_line(stage, fit))
    taken = 0
    while taken < steps:
        further = _further(stage, fit, min(_BLOCK, steps - taken))
        taken += _BLOCK
        gained = further.first_cost - further.cost if further is not fit else 0.0
        fit = further
        if gained < _NOTHING * fit.cost or fit.evidence - _PATIENCE * gained > best + allowed:
            break
    return fit


def _key(fit: Fit) -> tuple[str, str]:
    return fit.last.key


def _further(stage: Stage, fit: Fit, steps: int) -> Fit:
    """Some steps more; and again while the cost still falls by leaps."""
    if fit.converged and fit.on is not None and fit.on[0] is stage:
        return fit
    for _ in range(_MOST_LEAPS):
        further = fit_hypothesis(stage, fit.hypothesis, resumed=fit, max_iterations=steps)
        leapt = further.n_iterations == steps and further.cost < _LEAP * further.first_cost
        fit = further
        if not leapt:
            break
    return fit


def _leading(fits: Sequence[Fit], base: Fit | None) -> list[Fit]:
    """By evidence; one for each effect and place, and none hopeless beside the best or the base.

    Where much is to be gained over the base, and two effects may share it, a part of it is hope.
    """
    if not fits:
        return []
    kept: dict[tuple[tuple[str, str], ...], Fit] = {}
    for fit in sorted(fits, key=lambda f: f.evidence):
        kept.setdefault(tuple(i.key for i in fit.hypothesis.instances), fit)
    ordered = list(kept.values())
    behind = _HOPELESS
    if base is not None:
        gained = base.evidence - ordered[0].evidence
        behind = max(behind, (1.0 - _LARGE_PART) * gained)
    worst = ordered[0].evidence + behind
    if base is not None:
        worst = min(worst, base.evidence - _PROMISE)
    return [f for f in ordered if f.evidence < worst]
