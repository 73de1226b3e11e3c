"""How far hits turn each joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.linearised import joint_postures
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.steps import STEPS
from armodal.analyzer.gap.model.swings import forces_of, free_turns

__all__ = ["swings_of"]


def swings_of(
    hypothesis: Hypothesis,
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
) -> tuple[tuple[str, float, float], ...]:
    """Largest turn in rad of each elastic joint under hits of the middle level, its rate over it.

    As a hypothesis without laws foretells it; lines with their hits' peaks.

    Returns
    -------
    Joint, rad and rad/s of each.
    """
    ordinary = hypothesis.ordinary
    joints = tuple(ordinary.arm.joints[i].name for i in ordinary.elastic)
    postures = joint_postures(hypothesis, models, lines, values, joints)
    first = {own.name: own for own in reversed(lines)}
    # A joint swings most soon; at the end of the record what wraps around it is blown up.
    t = STEPS.seconds[: len(STEPS.seconds) // 2]
    found = []
    for at, joint in enumerate(joints):
        largest, rate = 0.0, 1.0
        for name, posture in postures.items():
            own = first[name]
            forces = forces_of(own.peaks_n * np.exp(-own.level), own.width_s)
            turns = free_turns(posture.swings[at], own.hit, forces)[:, : len(t)]
            turn = turns[np.argmax(np.abs(turns).max(axis=1))]
            if np.abs(turn).max() > largest:
                largest = float(np.abs(turn).max())
                rate = float(np.linalg.norm(np.gradient(turn, t)) / np.linalg.norm(turn))
        found.append((joint, largest, rate))
    return tuple(found)
