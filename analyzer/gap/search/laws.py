"""Joints' own laws beside a model: where they are looked for, and where their fits begin."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage, cost_of, fit_hypothesis
from armodal.analyzer.gap.library import hooks
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.linearised import joint_postures, linearised_about_each
from armodal.analyzer.gap.search.levels import changes_with_level
from armodal.analyzer.gap.search.race import STEPS, Race
from armodal.analyzer.gap.search.scan import LOOK

__all__ = ["fitted_laws"]


def fitted_laws(
    races: Mapping[Stage, Race],
    base: Fit,
    tell: Callable[[str], None],
    *,
    is_wanted: Callable[[float], bool],
) -> list[Fit]:
    """Every law of its own of the joint whose spring and damper change most with the level.

    A law's swings depend on its parameters by more than their slopes, and on sharp lines most
    starts lead elsewhere: each is fitted on broad lines first.

    Parameters
    ----------
    races
        Of the widest, broad, middle and sharp lines.
    base
        The present hypothesis on sharp lines; without levels, or with an effect of them, there is
        nothing to do.
    is_wanted
        Asked of what that joint's change promises.

    Returns
    -------
    Some steps of each on sharp lines; of the best all.
    """
    present, ordinary = base.hypothesis, base.hypothesis.ordinary
    if not ordinary.swings or present.level_dependent:
        return []
    _, broad, *_, sharp = races
    most = changes_with_level(sharp, base)[0]
    if most.gain < LOOK or not is_wanted(most.gain):
        return []
    joint = most.instance.place
    of_joint = next(swing for swing in ordinary.swings if swing[0] == joint)
    before = fit_hypothesis(broad, present, resumed=base, max_iterations=STEPS)
    race, begun = races[broad], []
    for instance in (law for make in hooks("laws") for law in make(ordinary, *of_joint)):
        tell(f"a law of its own: {instance.title}")
        richer = replace(present, instances=(*present.instances, instance))
        start = _best_start(broad, richer, before)
        if start is not None:
            begun.append(race.fit(richer, start=start))
    ahead = sorted(begun, key=lambda fit: fit.evidence)
    found = [race.to_its_end(fit) for fit in ahead if not race.is_hopeless(fit)]
    found = sorted((f for f in found if not race.is_hopeless(f)), key=lambda fit: fit.evidence)
    there = races[sharp]
    fits = [there.fit(fit.hypothesis, resumed=fit) for fit in found[:1]]
    # What leads goes to its end first: the others are soon set beside what they have to reach.
    fits = [there.to_its_end(fit) for fit in fits]
    return [*fits, *(there.fit(fit.hypothesis, resumed=fit) for fit in found[1:])]


def _best_start(stage: Stage, hypothesis: Hypothesis, base: Fit) -> Mapping[str, float] | None:
    """Of least cost, each with the joint's spring such that, with its law, it stays what it was.

    None where no swing under the law stays finite.
    """
    last = hypothesis.instances[-1]
    if last.law is None or last.initial_values is None:
        return None
    space = hypothesis.space()
    near = joint_postures(
        base.hypothesis, stage.models, stage.lines, base.values, (last.law.joint,)
    )
    begins = [space.values(space.start(own)) for own in last.initial_values(base.values)]
    every = linearised_about_each(hypothesis, stage.models, stage.lines, near, begins)
    postures = range(len(stage.lines))
    costs = [cost_of(stage, about, space, space.start(own), postures) for about, own in every]
    return every[int(np.argmin(costs))][1] if min(costs, default=np.inf) < np.inf else None
