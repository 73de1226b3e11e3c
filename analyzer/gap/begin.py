"""What a gap analysis begins with: the arm as believed, and what each mounting has of its own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.model.hit_levels import has_hits_between, has_levels
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.errors import ArmError
from armodal.protocols.session.records import Session

__all__ = ["ordinary_of", "with_places"]

_NEAR_STEPS = 3


def ordinary_of(
    sessions: Sequence[Session], superset: Superset, lines: Sequence[PostureLines]
) -> Ordinary:
    """Return what is ordinary about the arm of some sessions, on lines of their postures.

    Raises
    ------
    ArmError
        If two parameters have one name: joints 'A' and 'relaxing A' make two of 'loss relaxing A'.
    """
    levels_hit = all(bool(session.hits) and has_levels(session) for session in sessions)
    ordinary = Ordinary(
        superset=superset,
        postures=tuple(own.name for own in lines),
        hit_points=_hit(superset, lines),
        one_is_hit=any(len(own.hit_point) == 1 for own in lines),
        levels_hit=levels_hit,
        hits_between=levels_hit and any(has_hits_between(session) for session in sessions),
    )
    counts = Counter(p.name for p in ordinary.parameters())
    twice = ", ".join(f"'{name}'" for name, n in counts.items() if n > 1)
    if twice:
        raise ArmError(
            f"arm '{superset.arm.name}': wanted a name of its own for every parameter, got {twice} "
            "twice; rename joints or links in the arm file"
        )
    return ordinary


def _hit(superset: Superset, lines: Sequence[PostureLines]) -> tuple[str, ...]:
    """Points that are hit."""
    hit = [int(point) for own in lines for point in own.hit_point]
    return tuple(superset.arm.points[point].id for point in dict.fromkeys(hit))


def with_places(
    stages: Sequence[Stage], present: Hypothesis, start: Mapping[str, float]
) -> tuple[tuple[Stage, ...], Mapping[str, float]]:
    """Return stages that allow for errors of single mountings, as the hypothesis foretells them.

    And the values by which it does on the last of them.
    """
    found: list[Stage] = []
    values = dict(start)
    for stage in stages:
        near = fit_hypothesis(
            stage, present, start=values, max_iterations=_NEAR_STEPS, closing=False
        )
        values = near.values
        found.append(stage.with_places(present, values))
    return tuple(found), values
