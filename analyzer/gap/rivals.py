"""Rivals for what the present hypothesis does not explain: all looked at, the best fitted sharply.

Three stages, from broad lines to sharp ones. On the broad lines the present hypothesis is fitted,
every effect is looked at linearly and the most promising are fitted; the best of those go on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analyzer.gap.effects.effect import Instance
from analyzer.gap.fit import Fit, Stage, fit_hypothesis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.library import all_instances
from analyzer.gap.scan import Candidate, scan_axes, scan_instances
from analyzer.gap.sensors import scan_sensors

__all__ = ["Rivals", "find_rivals"]

_LOOKED_AT, _SHARPENED, _FINALISTS = 10, 6, 4
_MOST_AXES = 4
_WORTH = 4.0  # of cost on the broad lines; less is not worth a fit

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivals:
    """The hypothesis so far and its rivals on the sharp lines, best evidence first."""

    present: Fit
    rivals: tuple[Fit, ...]
    looked_at: tuple[Candidate, ...]  # all, by linear gain


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
        Broad, middle and sharp lines of the same postures.
    """
    broad, middle, sharp = stages
    tell("the arm as believed")
    base = fit_hypothesis(broad, present, start=start, postures=postures, max_iterations=7)
    taken = {instance.key for instance in present.instances}
    looked_at = _looked_at(broad, base, taken, start or {})
    coarse: list[Fit] = []
    for candidate in _most_promising(looked_at):
        tell(candidate.instance.title)
        begin = base.values
        if candidate.instance.effect.name in ("flipped_axis", "swapped_axes"):
            begin = start or {}  # the fit without it went astray
        richer = replace(present, instances=(*present.instances, candidate.instance))
        coarse.append(
            fit_hypothesis(broad, richer, start=begin, postures=postures, max_iterations=7)
        )
    coarse.sort(key=lambda f: f.evidence)
    middle_fits = [
        fit_hypothesis(middle, f.hypothesis, start=f.values, postures=postures, max_iterations=5)
        for f in [base, *_distinct(coarse)[:_SHARPENED]]
    ]
    base, others = middle_fits[0], sorted(middle_fits[1:], key=lambda f: f.evidence)
    finals = []
    for f in [base, *others[:_FINALISTS]]:
        tell(f"sharply: {f.hypothesis.name}")
        finals.append(fit_hypothesis(sharp, f.hypothesis, start=f.values, postures=postures))
    return Rivals(
        present=finals[0],
        rivals=tuple(sorted(finals[1:], key=lambda f: f.evidence)),
        looked_at=tuple(looked_at),
    )


def _looked_at(
    stage: Stage, base: Fit, taken: set[tuple[str, str]], start: dict[str, float]
) -> list[Candidate]:
    hypothesis = base.hypothesis
    found = scan_instances(
        stage, base, [i for i in all_instances(hypothesis.ordinary) if i.key not in taken]
    )
    axes_taken = [place for name, place in taken if name == "link_axis"]
    found += scan_axes(stage, base, exclude=axes_taken)
    found += scan_sensors(stage, hypothesis, base.values)
    first = hypothesis.space()
    guess = first.values(first.start(start))
    found += scan_sensors(stage, hypothesis, guess)
    best: dict[tuple[str, str], list[Candidate]] = {}
    for candidate in sorted(found, key=lambda c: -c.gain):
        same = best.setdefault(candidate.instance.key, [])
        if not same or candidate.instance.effect.name == "link_axis":
            same.append(candidate)
    every = [c for group in best.values() for c in group if c.instance.key not in taken]
    return sorted(every, key=lambda c: -c.gain)


def _most_promising(candidates: Sequence[Candidate]) -> list[Candidate]:
    chosen: list[Candidate] = []
    axes = 0
    for candidate in candidates:
        if candidate.gain < _WORTH or len(chosen) == _LOOKED_AT:
            break
        if candidate.instance.effect.name == "link_axis":
            axes += 1
            if axes > _MOST_AXES:
                continue
        chosen.append(candidate)
    return chosen


def _distinct(fits: Sequence[Fit]) -> list[Fit]:
    """The best fit of every effect at every place."""
    seen: set[tuple[tuple[str, str], ...]] = set()
    kept = []
    for fit in fits:
        key = tuple(i.key for i in fit.hypothesis.instances)
        if key not in seen and np.isfinite(fit.evidence):
            seen.add(key)
            kept.append(fit)
    return kept
