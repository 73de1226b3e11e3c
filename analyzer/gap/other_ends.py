"""A damper that leads may end on other links: broad lines at the start tell its links badly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from armodal.analyzer.gap.effects.effect import Instance
from armodal.analyzer.gap.fit import Fit, Stage, better_start, fit_hypothesis
from armodal.analyzer.gap.library import all_instances

__all__ = ["other_ends"]

_KIND = "nonproportional"


def other_ends(stage: Stage, fits: Sequence[Fit], steps: int) -> list[Fit]:
    """Fits with a damper between other links, as strong as the one that leads."""
    found = []
    for fit in fits:
        *others, damper = fit.hypothesis.instances
        if damper.effect.name != _KIND:
            continue
        rest = {k: v for k, v in fit.values.items() if k not in damper.owned}
        for other in all_instances(fit.hypothesis.ordinary):
            is_new = other.effect.name == _KIND and other.key != damper.key
            if not is_new or any(other.excludes(known) for known in others):
                continue
            richer = replace(fit.hypothesis, instances=(*others, other))
            as_strong = {**rest, other.size: fit.values[damper.size]}
            starts = [as_strong, {**as_strong, **_shared_end(fit, damper, other)}]
            begin = better_start(stage, richer, starts)
            found.append(fit_hypothesis(stage, richer, start=begin, max_iterations=steps))
    return found


def _shared_end(fit: Fit, damper: Instance, other: Instance) -> dict[str, float]:
    """Where a damper ends on the link that it shares with another, in that one's parameters."""
    same_from, same_to = (
        a == b for a, b in zip(damper.place.split(" and "), other.place.split(" and "), strict=True)
    )
    names = list(zip(other.shapes, damper.shapes, strict=True))
    half = len(names) // 2
    shared = (names[:half] if same_from else []) + (names[half:] if same_to else [])
    return {new: fit.values[old] for new, old in shared}
