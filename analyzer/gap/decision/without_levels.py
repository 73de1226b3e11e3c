"""Where points were not hit softly and hard: what a change with the level looks like has no name.

A hit of one level moves a joint more in one posture than in another, so a joint that softens, slips
or sticks changes with the posture: without other levels that is a gravity compensator or a damper
between links. Only other levels tell (`docs/decisions/0019-names-that-need-levels.md`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from armodal.analyzer.arm.same_parts import check_same_parts
from armodal.analyzer.gap.decision.data_requirements import check_data_requirements
from armodal.analyzer.gap.effects.level import COVERED
from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.model.hit_levels import has_levels
from armodal.protocols.errors import EstimateError
from armodal.protocols.session.records import Session

__all__ = ["ALIKE", "LEVELS_NEEDED", "first_with_levels", "is_alike", "titles"]

ALIKE = "a joint that changes with the hits' level"
LEVELS_NEEDED = f"without points hit softly and hard {ALIKE} looks the same"


def is_alike(fit: Fit) -> bool:
    """Whether a joint that changes with the hits' level could look like the last effect."""
    hypothesis = fit.hypothesis
    if hypothesis.ordinary.levels_hit or not hypothesis.instances:
        return False
    return hypothesis.instances[-1].effect.name in COVERED


def titles(standing: Sequence[Fit]) -> str:
    """Return what stands, in words, and what no model here is of.

    A model that has nothing beside what all have, where others have something, is of nothing more.
    """
    counts = [len(fit.hypothesis.instances) for fit in standing]
    more = [f.title for f, n in zip(standing, counts, strict=True) if n > min(counts)]
    if any(is_alike(fit) for fit in standing):
        return " or ".join(
            [*(more or [f.title for f in standing if f.hypothesis.instances]), ALIKE]
        )
    return " or ".join([*more, "nothing more"] if more else [fit.title for fit in standing])


def first_with_levels(
    session: Session, more: Sequence[Session]
) -> tuple[Session, tuple[Session, ...], tuple[int, ...], list[str]]:
    """The session to begin with, further ones, their numbers as given, and what is to be said.

    Where the first has no hits at several levels and a further one has, and can carry the
    judgement, that is begun with, and those without levels are left out. The first given is 1.
    """
    every = tuple(range(1, len(more) + 2))
    if has_levels(session):
        return session, tuple(more), every, []
    chosen = next(
        (other for other in more if has_levels(other) and _meets_requirements(other)), None
    )
    if chosen is None:
        return session, tuple(more), every, []
    check_same_parts(session.header.arm, chosen.header.arm)
    levelled = {
        n: other
        for n, other in enumerate(more, start=2)
        if other is not chosen and has_levels(other)
    }
    left = len(more) - len(levelled)
    words = "1 session without was" if left == 1 else f"{left} sessions without were"
    number = next(n for n, other in enumerate(more, start=2) if other is chosen)
    note = f"test {number} has hits at several levels; {words} left out"
    if levelled:
        note += f"; below, test 2 is what was given as test {min(levelled)}"
        note += ", and so on" if len(levelled) > 1 else ""
    first = replace(chosen, header=replace(chosen.header, arm=session.header.arm))
    return first, tuple(levelled.values()), (number, *levelled), [note]


def _meets_requirements(session: Session) -> bool:
    try:
        check_data_requirements(session)
    except EstimateError:
        return False
    return True
