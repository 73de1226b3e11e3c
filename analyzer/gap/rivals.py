"""Rivals for what the present hypothesis does not explain: all looked at, the best fitted sharply.

Three stages, from broad lines to sharp ones. On the broad lines the present hypothesis is fitted,
every effect is looked at linearly and the most promising are fitted; the best of those go on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from analyzer.gap.effects.effect import Instance
from analyzer.gap.fit import Fit, Stage, fit_hypothesis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.library import all_instances
from analyzer.gap.scan import Candidate, scan_axes, scan_instances
from analyzer.gap.sensors import scan_sensors

__all__ = ["Rivals", "find_rivals"]

_FIRST_STEP, _COARSE, _MIDDLE, _FINALISTS = 20, 7, 4, 3
_MOST_AXES = 6
_WORTH = 4.0  # of cost on the broad lines; less is not worth a fit
# Evidence behind the best at which a rival is dropped: the sharper lines weigh some five times more.
_HOPELESS = 400.0
_PROMISE = 1.0  # of evidence over the present hypothesis, to be fitted on sharper lines

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
        begin = base.values
        if candidate.instance.effect.name in ("flipped_axis", "swapped_axes"):
            begin = start or {}  # the fit without it went astray
        richer = replace(present, instances=(*present.instances, candidate.instance))
        coarse.append(
            fit_hypothesis(broad, richer, start=begin, postures=postures, max_iterations=1)
        )
    coarse.sort(key=lambda f: f.cost)
    best: list[Fit] = []
    for f in coarse[:_COARSE]:
        tell(f.hypothesis.name)
        best.append(_further(broad, f, postures, 6))
    best = [_further(middle, f, postures, 5) for f in _leading(best, base)[:_MIDDLE]]
    base = _further(middle, base, postures, 5)
    finals = []
    for f in _leading(best, base)[:_FINALISTS]:
        tell(f"sharply: {f.hypothesis.name}")
        finals.append(_further(sharp, f, postures, 8))
    tell(f"sharply: {present.name}")
    finals.insert(0, _further(sharp, base, postures, 8))
    return Rivals(
        present=finals[0],
        rivals=tuple(sorted(finals[1:], key=lambda f: f.evidence)),
        looked_at=tuple(looked_at),
    )


def _further(stage: Stage, fit: Fit, postures: Sequence[int] | None, steps: int) -> Fit:
    return fit_hypothesis(
        stage, fit.hypothesis, start=fit.values, postures=postures, max_iterations=steps
    )


def _leading(fits: Sequence[Fit], base: Fit) -> list[Fit]:
    """By evidence; one for each effect and place, and none hopeless beside the best or the base."""
    kept: dict[tuple[tuple[str, str], ...], Fit] = {}
    for fit in sorted(fits, key=lambda f: f.evidence):
        kept.setdefault(tuple(i.key for i in fit.hypothesis.instances), fit)
    ordered = list(kept.values())
    return [
        f
        for f in ordered
        if f.evidence < min(ordered[0].evidence + _HOPELESS, base.evidence - _PROMISE)
    ]


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
        if candidate.gain < _WORTH or len(chosen) == _FIRST_STEP:
            break
        if candidate.instance.effect.name == "link_axis":
            axes += 1
            if axes > _MOST_AXES:
                continue
        chosen.append(candidate)
    return chosen
