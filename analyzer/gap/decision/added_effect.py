"""A name more in the model: likelier ones in the place of axes, and what it makes unneeded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from armodal.analyzer.gap.decision.calibration import Calibration
from armodal.analyzer.gap.decision.judge import Judged, is_plainer
from armodal.analyzer.gap.decision.matters import is_material, matters
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.library import together
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.search.race import PATIENCE, STEPS
from armodal.analyzer.gap.search.rivals import annealed

__all__ = ["Step", "beside_rivals", "with_step"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """An effect's way into the model: without and with it, and the judgement."""

    without: Fit
    fit: Fit
    gains: Mapping[str, float]  # by posture, foretold from the others: log density with it more
    judged: Judged


def with_step(
    stages: Sequence[Stage],
    named: Sequence[Step],
    step: Step,
    begin: Mapping[str, float],
    notes: list[str],
) -> tuple[Fit, list[Step]]:
    """Return the model with one name more, and the steps that still earn their place.

    Parameters
    ----------
    stages
        Widest, broad, middle and sharp lines.
    named, step
        Before it, and the one that adds the name.
    begin
        Values of the arm file's effects, where a fit begins.
    notes
        Gets a line for every effect that is taken out again.
    """
    sharp = stages[-1]
    own = [old.fit.last.key for old in (*named, step)]
    better, swapped = _rather_than(sharp, step.fit, own)
    better, turned = _as_one(better)
    # The turn of an earlier step stands for both; one of the arm file has no step.
    is_in_a_step = bool(turned.keys() & {old.fit.last.key for old in named})
    if turned and not is_in_a_step:
        step = replace(step, fit=_with_last(better, *turned.values()))
    every = [_renamed(old, swapped | turned) for old in (named if is_in_a_step else [*named, step])]
    better = _begun_again(stages, better, begin)
    fitted, gone = _still_earning(sharp, better, step.judged.calibration)
    notes += [
        f"{i.title} was taken out again: beside the others it is no longer clear" for i in gone
    ]
    # By what an effect is: its law may have been worked out again since it was named.
    keys = {instance.key for instance in gone}
    return fitted, [step for step in every if step.fit.last.key not in keys]


def _begun_again(stages: Sequence[Stage], fit: Fit, begin: Mapping[str, float]) -> Fit:
    """The fit from nothing, if it is better than one that ended at a limit of ordinary errors.

    With an effect missing, ordinary errors and the effects that are there take on what it explains;
    from their limits no step leads back.
    """
    if len(fit.hypothesis.instances) == 1 or not fit.ordinary_at_limit:
        return fit
    again = annealed(stages, fit.hypothesis, begin)[-1]
    return again if again.evidence < fit.evidence else fit


def beside_rivals(
    stage: Stage, fit: Fit, rivals: Sequence[Fit], named: list[Step]
) -> tuple[Fit, list[Step]]:
    """Return the model with the better name for its last effect, and the steps with it.

    While an effect is missing, mountings err as a wrong model has it, and another effect may make
    up for that. Once one is there rivals are fitted again where mountings err as it foretells.

    Parameters
    ----------
    stage
        Sharp lines with such mountings.
    fit
        On them.
    rivals
        For the last effect, as they were fitted without.
    """
    *before, last = fit.hypothesis.instances
    for other in rivals:
        new = other.last
        if new.key == last.key or not _is_new_beside(before, new):
            continue
        instead = replace(fit.hypothesis, instances=(*before, new))
        quick = fit_hypothesis(stage, instead, start=other.values, max_iterations=STEPS)
        if quick.evidence - quick.promised > fit.evidence:
            continue
        ended = fit_hypothesis(stage, instead, resumed=quick)
        phi = named[-1].judged.phi
        if not _is_worth_it(stage, ended, fit, phi) or is_plainer(fit, ended, named[-1].without):
            continue
        if ended.evidence < fit.evidence:
            named = [_renamed(step, {last.key: new}) for step in named]
            fit, last = ended, new
    return fit, named


def _rather_than(
    stage: Stage, fit: Fit, own: Sequence[tuple[str, str]]
) -> tuple[Fit, dict[tuple[str, str], Instance]]:
    """The fit with better names in the place of those it has; which stands for which.

    A name of an earlier round was judged while something else was missing. Those of the arm file
    stay.
    """
    swapped: dict[tuple[str, str], Instance] = {}
    for old in fit.hypothesis.instances:
        if old.key not in own or old.alternatives is None:
            continue
        others = [i for i in fit.hypothesis.instances if i is not old]
        for new, begin in old.alternatives(fit.values):
            if not _is_new_beside(others, new):
                continue
            instances = tuple(new if i is old else i for i in fit.hypothesis.instances)
            instead = replace(fit.hypothesis, instances=instances)
            quick = fit_hypothesis(stage, instead, start=begin, max_iterations=STEPS)
            if quick.evidence - quick.promised > fit.evidence:
                continue
            ended = fit_hypothesis(stage, instead, resumed=quick)
            if ended.evidence < fit.evidence:
                fit, swapped[old.key] = ended, new
                break
    return fit, swapped


def _is_new_beside(others: Sequence[Instance], new: Instance) -> bool:
    return new.goes_with(others) and all(new.key != other.key for other in others)


def _is_worth_it(stage: Stage, new: Fit, old: Fit, phi: float) -> bool:
    """Whether another last name is large enough, or the one that it would replace was not either.

    What holds the old one inside it always comes nearer to the data, by something too small.
    """
    return is_material(stage, new, new.last, phi) or not is_material(stage, old, old.last, phi)


def _taken_out(fit: Fit, gone: Instance) -> tuple[dict[str, float], Hypothesis]:
    """Where a fit without an effect begins: what stays may take what it was."""
    rest = tuple(i for i in fit.hypothesis.instances if i is not gone)
    values = dict(fit.values)
    for other, begin in () if gone.alternatives is None else gone.alternatives(fit.values):
        if any(other.key == i.key for i in rest):
            values |= begin
    for parameter in gone.parameters:
        values.pop(parameter.name, None)
    return values, replace(fit.hypothesis, instances=rest)


def _as_one(fit: Fit) -> tuple[Fit, dict[tuple[str, str], Instance]]:
    """Where the last effect and another are one: the fit with it, and for which it stands."""
    *others, last = fit.hypothesis.instances
    for other in others:
        both = together(fit.hypothesis.ordinary, other, last)
        if both is not None:
            instances = tuple(both if i is other else i for i in others)
            hypothesis = replace(fit.hypothesis, instances=instances)
            return replace(fit, hypothesis=hypothesis), {other.key: both}
    return fit, {}


def _with_last(fit: Fit, last: Instance) -> Fit:
    """The fit with one of its effects told as the last."""
    others = [i for i in fit.hypothesis.instances if i.key != last.key]
    return replace(fit, hypothesis=replace(fit.hypothesis, instances=(*others, last)), on=None)


def _renamed(step: Step, swapped: dict[tuple[str, str], Instance]) -> Step:
    fit = step.fit
    instances = tuple(swapped.get(i.key, i) for i in fit.hypothesis.instances)
    if instances == fit.hypothesis.instances:
        return step
    renamed = replace(fit, hypothesis=replace(fit.hypothesis, instances=instances), on=None)
    standing = tuple(renamed if f is fit else f for f in step.judged.standing)
    return replace(step, fit=renamed, judged=replace(step.judged, standing=standing))


def _still_earning(stage: Stage, fit: Fit, calibration: Calibration) -> tuple[Fit, list[Instance]]:
    """Take out effects, added before the last, that the later ones made unneeded."""
    gone: list[Instance] = []
    while True:
        for instance in fit.hypothesis.instances[:-1]:
            start, hypothesis = _taken_out(fit, instance)
            fewer = fit_hypothesis(stage, hypothesis, start=start, max_iterations=STEPS)
            limit, phi = calibration.limit(instance.effect.name), calibration.inflation
            small = not matters(stage, fewer, fit, instance, phi)
            if small or fewer.evidence - PATIENCE * fewer.promised < fit.evidence + limit:
                fewer = fit_hypothesis(stage, hypothesis, resumed=fewer)
                small = not matters(stage, fewer, fit, instance, phi)
            if small or fewer.evidence - fit.evidence < limit:
                gone.append(instance)
                fit = fewer
                break
        else:
            return fit, gone
