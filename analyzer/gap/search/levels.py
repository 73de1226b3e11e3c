"""Whether the response depends on the hit's level; only then soft and hard hits are kept apart.

The check of homogeneity without a model (`analyzer.checks.homogeneity`) sees modes move one
posture at a time. With a model every joint has one column in all postures, odd in the level, and
what ordinary errors leave is even in it: much smaller changes are seen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.largest_swings import swings_of
from armodal.analyzer.gap.model.lines import PostureLines, scatter
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.scan import LOOK, Candidate, scan_instances

__all__ = [
    "Apart",
    "any_level",
    "changes_with_level",
    "fit_with",
    "told_apart",
    "weighed_anew",
]


def changes_with_level(stage: Stage, fit: Fit) -> list[Candidate]:
    """What a common change of each joint with the level promises, best first.

    Nothing where soft and hard hits are not told apart, or an effect of a model follows the level.
    """
    changes = any_change(fit.hypothesis.ordinary)
    if fit.hypothesis.level_dependent or not changes:
        return []
    return scan_instances(stage, fit, changes)


def fit_with(stage: Stage, fit: Fit, change: Instance) -> Fit:
    """Fit a model with a look's change beside what it has."""
    wider = replace(fit.hypothesis, instances=(*fit.hypothesis.instances, change))
    return fit_hypothesis(stage, wider, start=fit.values)


@dataclass(frozen=True, slots=True, kw_only=True)
class Apart:
    """Soft and hard hits, kept apart."""

    stages: tuple[Stage, ...]  # but the widest, weighed anew
    # Nats of cost that a common change of one joint with the level promises; infinite where the
    # model has a law.
    gain: float
    swings: tuple[tuple[str, float, float], ...]  # of each joint (`largest_swings.swings_of`)


def told_apart(
    superset: Superset,
    level_apart: Callable[[int], Stage],
    present: Hypothesis,
    start: Mapping[str, float],
    discrepancy: Discrepancy,
) -> Apart | None:
    """Keep soft and hard hits apart, if the hits' level tells something.

    First all of the difference between soft and hard hits counts as variance; then, once every
    joint may change with the level, only what that leaves: aims of single hits, and what a spring
    and a damper at each level are not.

    Parameters
    ----------
    level_apart
        Gives a stage by its number, soft and hard hits in turn (`lines.own_lines`). All but the
        widest, 0, are asked for.
    present
        A hypothesis about levelled lines (`Ordinary.level_span`).

    Returns
    -------
    None where a common change of one joint with the level promises too little to tell anything,
    and the model has no law.
    """
    broad, middle = level_apart(1), level_apart(2)
    fit = fit_hypothesis(broad, present, start=start, closing=False)
    fit = fit_hypothesis(middle, present, start=fit.values)
    # A law of the arm file follows the level: what is asked is whether it follows it rightly.
    gain = np.inf if present.level_dependent else changes_with_level(middle, fit)[0].gain
    if gain < LOOK:
        return None
    free = any_level(middle, present, fit.values)
    anew = tuple(
        Stage(superset, weighed_anew(stage, free), discrepancy, models=stage.models)
        for stage in (broad, middle, level_apart(3))
    )
    known = all(own.width_s > 0.0 for own in middle.lines)  # of the hits
    swings = swings_of(present, middle.models, middle.lines, fit.values) if known else ()
    return Apart(stages=anew, gain=gain, swings=swings)


def any_level(stage: Stage, present: Hypothesis, start: Mapping[str, float]) -> Fit:
    """Fit a hypothesis with every joint free to change with the hit's level."""
    wider = replace(present, instances=(*present.instances, *any_change(present.ordinary)))
    return fit_hypothesis(stage, wider, start=start, closing=False)


def weighed_anew(stage: Stage, free: Fit) -> list[PostureLines]:
    """Lines of a posture's levels with what a fit leaves of their differences as variance."""
    hypothesis, values = free.hypothesis, free.values
    of_posture: dict[str, list[int]] = {}
    for i, lines in enumerate(stage.lines):
        of_posture.setdefault(lines.name, []).append(i)
    found: list[PostureLines] = []
    for own in of_posture.values():
        measured = [stage.lines[i].values for i in own]
        foretold = [stage.models[i].values(hypothesis, stage.lines[i], values) for i in own]
        less = scatter(measured)
        more = scatter([a - b for a, b in zip(measured, foretold, strict=True)])
        # All were added to: what is left is positive but for rounding.
        found += [
            replace(lines, variance=np.maximum(lines.variance - less, 0.0) + more)
            for lines in (stage.lines[i] for i in own)
        ]
    return found
