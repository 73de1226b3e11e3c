"""Of many fits the best: of each effect, place and minimum; and which may still come beside."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.search.race import BESIDE, PATIENCE

__all__ = ["each_minimum", "hopeful", "one_each"]


def one_each(fits: Sequence[Fit]) -> list[Fit]:
    """By evidence, the best of each effect and place."""
    kept: dict[tuple[tuple[str, str], ...], Fit] = {}
    for fit in sorted(fits, key=lambda f: f.evidence):
        kept.setdefault(_keys(fit), fit)
    return list(kept.values())


def each_minimum(fits: Sequence[Fit]) -> list[Fit]:
    """By evidence, the best of each effect and place, and what may still end in a better minimum.

    Of an effect that has several, after some steps the best may be on its way to the worse one.
    """
    kept: list[Fit] = []
    best: dict[tuple[tuple[str, str], ...], float] = {}
    for fit in sorted(fits, key=lambda f: f.evidence):
        reached = fit.evidence
        if fit.last.effect.separate_minima:
            reached -= PATIENCE * fit.promised
        if reached < best.setdefault(_keys(fit), float("inf")):
            kept.append(fit)
            best[_keys(fit)] = min(best[_keys(fit)], fit.evidence)
    return kept


def _keys(fit: Fit) -> tuple[tuple[str, str], ...]:
    return tuple(instance.key for instance in fit.hypothesis.instances)


def hopeful(fits: Sequence[Fit]) -> list[Fit]:
    """One of each effect, place and minimum, by evidence, that may still come beside the best."""
    each = each_minimum(fits)
    return [f for f in each if f.evidence - PATIENCE * f.promised < each[0].evidence + BESIDE]
