"""A hypothesis fitted to some postures, to see what it foretells of the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.protocols.session.records import Session

__all__ = ["HeldOut", "held_out", "held_out_postures"]

_MOST_STEPS = 6  # from a fit to all postures that to some is near


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut:
    """A hypothesis on postures it was not fitted to."""

    training: Fit
    postures: tuple[int, ...]


def held_out_postures(session: Session, lines: Sequence[PostureLines]) -> tuple[int, ...]:
    """Held out are the plan's validation postures, without any the last third; and changed states.

    A known mass that was bolted on changes what every effect does, by an amount that is known: a
    model that is right foretells it.
    """
    changed = {i for i, posture in enumerate(lines) if posture.known_mass is not None}
    if len(changed) == len(lines):
        changed = set()
    planned = {p.name for p in session.header.plan.postures if p.validation}
    test = {i for i, posture in enumerate(lines) if posture.name in planned}
    if not test or len(test | changed) == len(lines):
        names = list(dict.fromkeys(p.name for i, p in enumerate(lines) if i not in changed))
        last = names[-max(len(names) // 3, 1) :]
        test = {i for i, posture in enumerate(lines) if posture.name in last}
    held = test | changed
    return tuple(sorted(held if len(held) < len(lines) else test))


def held_out(stage: Stage, fit: Fit, test: Sequence[int]) -> HeldOut:
    """Fit to all postures but `test`.

    Parameters
    ----------
    fit
        A fit to all postures: where the fit to some begins.
    test
        Indices of the held-out postures.
    """
    training_postures = [p for p in range(len(stage.lines)) if p not in test]
    training = fit_hypothesis(
        stage,
        fit.hypothesis,
        start=_without(fit, stage, test),
        postures=training_postures,
        max_iterations=_MOST_STEPS,
    )
    return HeldOut(training=training, postures=tuple(test))


def _without(fit: Fit, stage: Stage, test: Sequence[int]) -> dict[str, float]:
    """Values to start from: nothing that only the held-out postures can have told."""
    own = {f"aim {side} {stage.lines[p].name}" for p in test for side in "ab"}
    return {name: value for name, value in fit.values.items() if name not in own}
