"""How well a hypothesis, fitted to some postures, foretells others.

The training postures leave a Gaussian of the parameters, their curvature A about the best point.
The log density of a held-out posture integrates over it (Laplace): with that posture's cost C,
slope g and curvature H, the training's own part in C and g, where both meet,

    -ln p = C - g'(A + H)^-1 g / 2 + ln det(A + H) / 2 - ln det A / 2 .

What is known only in that posture, its aim and its mountings, is integrated out likewise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.protocols.session.records import Session

__all__ = ["HeldOut", "held_out", "held_out_postures"]

_MEETING_STEPS = 5
_ENOUGH = 0.5  # nats that a further step must bring
_MOST_STEPS = 6  # from a fit to all postures that to some is near


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut:
    """A hypothesis on postures it was not fitted to."""

    training: Fit
    postures: tuple[int, ...]
    surprise: tuple[float, ...]  # -ln p of each held-out posture


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
    """Fit to all postures but `test`, and see how surprising those are.

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
    surprise = tuple(_surprise(stage, training, p) for p in test)
    return HeldOut(training=training, postures=tuple(test), surprise=surprise)


def _surprise(stage: Stage, training: Fit, posture: int) -> float:
    """Minus the log density of one posture's data: Laplace's, where data and training meet.

    What only this posture can tell, such as how its hits were aimed, may lie far from where the
    training begins: there one linear step is not enough.
    """
    space, f = training.space, training.free
    A = training.curvature[np.ix_(f, f)] + np.eye(int(f.sum()))
    trial, best, least = training.u, np.inf, np.inf
    for _ in range(_MEETING_STEPS):
        (part,) = stage.quadratics(training.hypothesis, space, space.values(trial), [posture])
        off = trial[f] - training.u[f]
        cost = part.cost + 0.5 * float(off @ A @ off)
        if cost >= best - _ENOUGH:
            break
        best = cost
        both = A + part.curvature[np.ix_(f, f)]
        slope = part.gradient[f] + A @ off
        step = np.linalg.solve(both, slope)
        least = best - 0.5 * float(slope @ step) + 0.5 * float(np.linalg.slogdet(both)[1])
        trial = trial.copy()
        trial[f] -= step
        trial = np.clip(trial, space.low, space.high)
    return least - 0.5 * float(np.linalg.slogdet(A)[1])


def _without(fit: Fit, stage: Stage, test: Sequence[int]) -> dict[str, float]:
    """Values to start from: nothing that only the held-out postures can have told."""
    own = {f"aim {side} {stage.lines[p].name}" for p in test for side in "ab"}
    return {name: value for name, value in fit.values.items() if name not in own}
