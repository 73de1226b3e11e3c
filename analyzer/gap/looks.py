"""A linear look at every effect at every place, and which of them deserve a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from armodal.analyzer.gap.effects.effect import Instance
from armodal.analyzer.gap.fit import Fit, Stage
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.scan import Candidate, scan_axes, scan_instances
from armodal.analyzer.gap.scan_dampers import scan_dampers
from armodal.analyzer.gap.scan_postures import scan_compensators
from armodal.analyzer.gap.sensors import scan_sensors

__all__ = ["goes_with", "look_at_all", "look_at_others"]

_SOUGHT = ("gravity_compensator", "nonproportional")  # by a look of their own
_SEVERAL_STARTS = ("link_axis", "gravity_compensator")


def look_at_others(stage: Stage, base: Fit) -> list[Candidate]:
    """Every effect at every place that a hypothesis has not, as it stands, best first."""
    taken = {instance.key for instance in base.hypothesis.instances}
    every = all_instances(base.hypothesis.ordinary)
    return scan_instances(stage, base, [i for i in every if i.key not in taken])


def look_at_all(
    stage: Stage,
    base: Fit,
    start: Mapping[str, float],
    *,
    from_start: bool,
    others: Sequence[Candidate] | None = None,
) -> list[Candidate]:
    """Every effect at every place by its linear gain; sensors also beside the first guess.

    `others` is what `look_at_others` saw, if that is at hand.
    """
    hypothesis = base.hypothesis
    taken = {instance.key for instance in hypothesis.instances}
    instances = [
        i
        for i in all_instances(hypothesis.ordinary)
        if i.key not in taken and goes_with(i, hypothesis)
    ]
    plain = [i for i in instances if i.effect.name not in _SOUGHT]
    if others is None:
        found = scan_instances(stage, base, plain)
    else:
        keys = {i.key for i in plain}
        found = [c for c in others if c.instance.key in keys]
    found += scan_compensators(stage, base, instances)
    found += scan_dampers(stage, base, instances)
    axes_taken = [place for name, place in taken if name == "link_axis"]
    found += scan_axes(stage, base, exclude=axes_taken)
    found += scan_sensors(stage, hypothesis, base.values)
    if from_start:
        first = hypothesis.space()
        found += scan_sensors(stage, hypothesis, first.values(first.start(start)))
    best: dict[tuple[str, str], list[Candidate]] = {}
    for candidate in sorted(found, key=lambda c: -c.gain):
        same = best.setdefault(candidate.instance.key, [])
        if not same or candidate.instance.effect.name in _SEVERAL_STARTS:
            same.append(candidate)
    every = [c for group in best.values() for c in group if c.instance.key not in taken]
    return sorted(every, key=lambda c: -c.gain)


def goes_with(instance: Instance, present: Hypothesis) -> bool:
    """Return whether an effect can stand beside those of a hypothesis."""
    return not any(instance.excludes(other) for other in present.instances)
