"""Rivals for what the present hypothesis does not explain: one search for all effects.

Every effect at every place is looked at linearly, where the present hypothesis stands. Where
something is to be explained the most promising are fitted on the widest lines, from their several
beginnings; the better part of them goes on to sharper lines, beside what each may stand for, until
a few are fitted on the finest lines. On wide lines nearly every start finds its way, and a fit
there costs a fifth of one on sharp lines; so as many are kept as cost about the same at every
stage. On each stage a fit goes on only while it may still come beside the best.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from armodal.analyzer.gap.inference.fit import (
    Fit,
    Stage,
    fit_hypothesis,
)
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.search.beginnings import LEADING
from armodal.analyzer.gap.search.best_fits import each_minimum, hopeful, one_each
from armodal.analyzer.gap.search.candidates import (
    all_candidates,
    goes_with,
    other_candidates,
    others_beside,
)
from armodal.analyzer.gap.search.first_steps import first_steps
from armodal.analyzer.gap.search.laws import fitted_laws
from armodal.analyzer.gap.search.nearby import Nearby
from armodal.analyzer.gap.search.race import BESIDE, MOST_STEPS, PATIENCE, STEPS, Race
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["Rivals", "annealed", "find_rivals"]

_KEPT = 28  # candidates fitted on the widest lines; on each sharper stage half as many

Progress = Callable[[str], None]
NeedsMore = Callable[[Fit, Sequence[Fit]], bool]
Limit = Callable[[Fit, str], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivals:
    """The hypothesis so far and its rivals on the sharp lines, best evidence first."""

    present: Fit
    rivals: tuple[Fit, ...]
    let_go: tuple[Fit, ...] = ()  # not fitted to the end: too far behind for these lines
    others: tuple[Candidate, ...] | None = None  # all effects by a linear look about the present

    def with_standing(self, standing: Sequence[Fit]) -> tuple[Fit, ...]:
        """The rivals and those that stand though no search led to them; best evidence first.

        Judging may set one effect beside its twin of another file.
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
    needs_more: NeedsMore,
    *,
    limit: Limit = lambda *_: 0.0,
    start: Mapping[str, float] | None = None,
    fitted: Fit | None = None,
    without: Collection[tuple[str, str]] = (),
    tell: Progress = lambda _: None,
    afresh: bool = True,
) -> Rivals:
    """Fit the present hypothesis and the effects that could improve on it.

    Parameters
    ----------
    stages
        Widest, broad, middle and sharp lines of the same postures.
    needs_more
        Whether a search that begins on wide lines is worth its time, by the present
        fit and the first steps of what promises most beside it.
    limit
        Nats that an effect needs beside a fit, by its name: where nothing else tells that more is
        needed, what promises most is begun, and of others none that promises far less.
    start
        Where its effects begin.
    fitted
        A sharp fit of the present hypothesis to all postures, if there is one.
    without
        Keys of instances that are not tried.
    afresh
        Whether `fitted` is set beside a fit from the start, before something more is looked for:
        what a fit left that ended in a local minimum is no other effect. In the end it is set
        beside one from where the best rival led.
    """
    *_, sharp = stages
    start = dict(start or {})
    search = partial(
        find_rivals,
        stages,
        present,
        needs_more,
        limit=limit,
        start=start,
        without=without,
        tell=tell,
    )
    tell("the arm as its file has it" + "".join(f", with: {i.title}" for i in present.instances))
    if fitted is None:
        base = annealed(stages, present, start)
    else:
        before = (stages[0], stages[-2])
        base = [fit_hypothesis(s, present, resumed=fitted, max_iterations=STEPS) for s in before]
        base.append(fitted)
    others = other_candidates(sharp, base[-1])
    looked = all_candidates(
        sharp, base[-1], start, from_start=False, others=others, without=without
    )
    races = {stage: Race(stage) for stage in stages}
    # What ends no better than the model without it has no name.
    race = races[sharp] = Race(sharp, behind=base[-1].evidence)

    blind = [i for i in others_beside(base[-2]) if i.key not in without]
    near = Nearby(races, base, looked, blind, start, most=_kept(len(stages) - 2))

    def reaches_limit(instance: Instance, gain: float) -> bool:
        return PATIENCE * gain > limit(base[-1], instance.effect.name)

    first = looked[0].instance if looked else None
    finals: list[Fit] = []
    is_more = needs_more(base[-1], ())
    if not is_more:
        # Limits are read from the residual, and what is missing is in that: it may hide itself.
        finals = hopeful(near.begun(lambda i, g: i is first or reaches_limit(i, g), reaches_limit))
        is_more = needs_more(base[-1], finals)
    if is_more:
        if fitted is not None and afresh:
            tell("from the start again, before more is looked for")
            anew = annealed(stages, present, _only_effects(present, start))[-1]
            if anew.evidence < fitted.evidence:
                return search(fitted=anew, afresh=False)
        most = looked[0].gain if looked else 0.0
        laws = fitted_laws(races, base[-1], tell, is_wanted=lambda gain: gain > most)
        laws = [f for f in laws if f.last.key not in without]
        explained = bool(laws) and not needs_more(min(laws, key=lambda f: f.evidence), ())
        far = [] if explained else _far(races, base, present, start, without, tell)
        # Where much is left they come after: most are hopeless beside what the wide lines led to.
        # A look about nothing may say far too little: what leads is begun anyway. What broad lines
        # promise is set beside what others reached there.
        finals += near.begun(
            lambda i, g: i is first or race.is_in_reach(base[-1], g),
            lambda _, g: races[stages[-2]].is_in_reach(base[-2], g),
        )
        finals = each_minimum([*finals, *far])
        finals = [*finals, *_alternatives(race, finals[:LEADING])]
        if not laws:
            in_reach = partial(race.is_in_reach, base[-1])
            laws = fitted_laws(races, base[-1], tell, is_wanted=in_reach)
        finals = each_minimum([f for f in (*finals, *laws) if f.last.key not in without])
    going_on = hopeful(finals)
    behind = [f for f in finals if all(f is not other for other in going_on)]
    ended = one_each([_ended(race, fit, tell) for fit in going_on])
    for best in ended[:1]:
        anew = race.to_its_end(race.fit(present, start=best.values))
        if anew.evidence < base[-1].evidence - BESIDE and not race.is_hopeless(anew):
            tell("again: begun where the best rival ended, the model needs none")
            return search(fitted=anew, afresh=False)
    return Rivals(
        present=base[-1],
        rivals=tuple(ended),
        let_go=tuple(behind[: _kept(len(stages) - 1)]),
        others=tuple(others),
    )


def _ended(race: Race, fit: Fit, tell: Progress) -> Fit:
    tell(f"fitted on the finest lines: {fit.hypothesis.name}")
    return race.to_its_end(fit)


def annealed(
    stages: Sequence[Stage], hypothesis: Hypothesis, start: Mapping[str, float]
) -> list[Fit]:
    """Fit a hypothesis on the lines of each stage, where the one before ended."""
    found: list[Fit] = []
    for stage in stages:
        values = found[-1].values if found else start
        # Of those between only the end is asked for.
        closing = stage in (stages[0], stages[-1])
        fit = fit_hypothesis(
            stage, hypothesis, start=values, max_iterations=MOST_STEPS, closing=closing
        )
        found.append(fit)
    return found


def _kept(stage: int) -> int:
    """How many fits go on to a stage; to none less than one."""
    return max(_KEPT >> stage, 1)


def _far(
    races: Mapping[Stage, Race],
    base: Sequence[Fit],
    present: Hypothesis,
    start: Mapping[str, float],
    without: Collection[tuple[str, str]],
    tell: Progress,
) -> list[Fit]:
    """What wide lines lead to, whatever the sharp fit made of it."""
    widest, *sharper = races
    # Ordinary errors may begin anew: they may have taken on what is missing.
    begin = {**start, **_only_effects(present, base[-1].values)}
    looked = all_candidates(widest, base[0], begin, from_start=True, without=without)
    tell(f"{len(looked)} candidates fitted on wide lines")
    race = races[widest]
    fits = each_minimum(
        [first_steps(race, base[0], c, begin, own_too=True) for c in _chosen(looked, _KEPT)]
    )
    for number, stage in enumerate(sharper, 1):
        fits = [*fits, *_alternatives(race, fits[:LEADING])]
        fits = hopeful([f for f in fits if f.last.key not in without])[: _kept(number)]
        if not fits:
            return []
        tell(f"{len(fits)} candidates fitted on sharper lines, first: {fits[0].hypothesis.name}")
        race = races[stage]
        leading, *others = fits
        fits = hopeful([race.to_its_end(leading), *(race.further(f) for f in others)])
    return fits


def _only_effects(present: Hypothesis, values: Mapping[str, float]) -> dict[str, float]:
    own = {name for instance in present.instances for name in instance.owned}
    return {name: value for name, value in values.items() if name in own}


def _chosen(looked: Sequence[Candidate], most: int) -> list[Candidate]:
    """The best place of every effect, then the best of all."""
    kinds: set[tuple[str, bool]] = set()
    first: list[Candidate] = []
    rest: list[Candidate] = []
    for c in sorted(looked, key=lambda c: -c.gain):
        kind = c.instance.effect.name, bool(c.instance.relaxes)
        (rest if kind in kinds else first).append(c)
        kinds.add(kind)
    return [*first, *rest][: max(most, len(first))]


def _alternatives(race: Race, fits: Sequence[Fit]) -> list[Fit]:
    """What leading fits may stand for."""
    found = []
    for fit in fits:
        *others, last = fit.hypothesis.instances
        if last.alternatives is None:
            continue
        rest = replace(fit.hypothesis, instances=tuple(others))
        for instance, begin in last.alternatives(fit.values):
            if goes_with(instance, rest) and all(instance.key != i.key for i in others):
                richer = replace(rest, instances=(*others, instance))
                found.append(race.fit(richer, start=begin))
    return found
