"""A linear look at every effect at every place, and which of them deserve a fit."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.library import all_instances, hooks
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.search.scan import Candidate, scan_instances

__all__ = ["all_candidates", "goes_with", "other_candidates", "others_beside"]


def others_beside(base: Fit) -> list[Instance]:
    """Return every effect at every place that a hypothesis has not and that can stand beside."""
    present = base.hypothesis
    taken = {instance.key for instance in present.instances}
    every = all_instances(present.ordinary)
    return [i for i in every if i.key not in taken and goes_with(i, present)]


def other_candidates(stage: Stage, base: Fit) -> list[Candidate]:
    """Every effect at every place that a hypothesis has not, as it stands, best first."""
    taken = {instance.key for instance in base.hypothesis.instances}
    every = all_instances(base.hypothesis.ordinary)
    return scan_instances(stage, base, [i for i in every if i.key not in taken])


def all_candidates(
    stage: Stage,
    base: Fit,
    start: Mapping[str, float],
    *,
    from_start: bool,
    others: Sequence[Candidate] | None = None,
    without: Collection[tuple[str, str]] = (),
) -> list[Candidate]:
    """Every effect at every place by its linear gain; sensors also beside the first guess.

    `others` is what `other_candidates` saw, if that is at hand; `without` are keys of instances
    that are not looked at.
    """
    hypothesis = base.hypothesis
    taken = {*without, *(instance.key for instance in hypothesis.instances)}
    instances = [
        i
        for i in all_instances(hypothesis.ordinary)
        if i.key not in taken and goes_with(i, hypothesis)
    ]
    plain = [i for i in instances if not i.effect.own_candidates]
    if others is None:
        found = scan_instances(stage, base, plain)
    else:
        keys = {i.key for i in plain}
        found = [c for c in others if c.instance.key in keys]
    found += [c for find in hooks("linear_candidates") for c in find(stage, base, instances)]
    guesses: list[Mapping[str, float]] = [base.values]
    if from_start:
        first = hypothesis.space()
        guesses.append(first.values(first.start(start)))
    for find in hooks("channel_candidates"):
        found += [c for guess in guesses for c in find(stage, hypothesis, guess)]
    best: dict[tuple[str, str], list[Candidate]] = {}
    for candidate in sorted(found, key=lambda c: -c.gain):
        same = best.setdefault(candidate.instance.key, [])
        if not same or candidate.instance.effect.separate_minima:
            same.append(candidate)
    every = [c for group in best.values() for c in group if c.instance.key not in taken]
    return sorted((c for c in every if goes_with(c.instance, hypothesis)), key=lambda c: -c.gain)


def goes_with(instance: Instance, present: Hypothesis) -> bool:
    """Return whether an effect can stand beside those of a hypothesis."""
    return instance.goes_with(present.instances)
