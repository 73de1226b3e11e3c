"""Joints' own laws beside a model: where they are looked for, and where their fits begin."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.library import hooks
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.linearised import joint_postures, kept_spring, linearised
from armodal.analyzer.gap.search.race import Race
from armodal.analyzer.gap.search.scan import scan_instances

__all__ = ["fitted_laws"]


def fitted_laws(
    race: Race, base: Fit, leading: Sequence[Instance], tell: Callable[[str], None]
) -> list[Fit]:
    """Every law of its own of the joint whose spring and damper change most with the level.

    Parameters
    ----------
    base
        The present hypothesis; without levels, or with an effect of them, there is nothing to do.
    leading
        Effects of the level at joints that are tried too.

    Returns
    -------
    Some steps of each; none at a joint whose change promises too little beside the best.
    """
    present, ordinary = base.hypothesis, base.hypothesis.ordinary
    if not ordinary.swings or present.level_dependent:
        return []
    most = scan_instances(race.stage, base, any_change(ordinary))[0]
    joints = [own.place for own in leading]
    if race.is_in_reach(base, most.gain):
        joints = [most.instance.place, *joints]
    swings = {joint: (swing, rate) for joint, swing, rate in ordinary.swings}
    found: list[Fit] = []
    for joint in dict.fromkeys(joints):
        every = (law for make in hooks("laws") for law in make(ordinary, joint, *swings[joint]))
        for instance in every:
            tell(f"a law of its own: {instance.title}")
            richer = replace(present, instances=(*present.instances, instance))
            start = _best_start(race.stage, richer, base)
            if start is not None:
                found.append(race.fit(richer, start=start))
    return found


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
    costs: list[float] = []
    starting_points: list[Mapping[str, float]] = []
    for begin in last.initial_values(base.values):
        try:
            kept = kept_spring(last.law, near, stage.lines, space.values(space.start(begin)))
            u = space.start(kept)
            values = space.values(u)
            about = linearised(
                hypothesis, stage.models, stage.lines, values, last=True, slopes=False, near=near
            )
            misfit = stage.misfit(about, values, range(len(stage.lines)))
        except np.linalg.LinAlgError:
            continue
        costs.append(sum(misfit) + 0.5 * float(u @ u))
        starting_points.append(values)
    return starting_points[costs.index(min(costs))] if costs else None
