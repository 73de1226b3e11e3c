"""Backlash in a joint's transmission, closed by larger motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.effects.level import COVERED, COVERED_HERE, LEAST
from armodal.analyzer.gap.effects.own_law import law_instance
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.joint_laws import Play
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "laws"]

_STD = 0.5  # of the joint's spring, the part that has the play
_LN_HALF, _LN_HALF_STD, _LN_HALF_LEAST, _LN_HALF_MOST = -1.0, 1.5, -5.0, 1.0  # of a middle swing

WORDS = EffectWords(
    name="backlash",
    title="Backlash in a joint's transmission",
    changes="a joint's stiffness grows with the hit's level, since play takes less of the motion",
    signature="softer hits see a softer joint, most in postures whose weight does not close it",
    confused_with=("softening",),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="a posture in which gravity loads the joint: the play closes",
    remedy="set the play of gear or belt, or test in postures that load the joint",
)


def laws(
    ordinary: Ordinary, joint: str, swing_rad: float, rate_rad_s: float
) -> tuple[Instance, ...]:
    """A part of the joint's spring, or all of it, holds nothing over a play.

    Between its flanks at rest; or where weight loads the joint, on the side it lays it to.
    """
    part, half = f"play {joint}", f"ln half play {joint}"

    def at_rest(*, carries: bool) -> Instance:
        def element(values: Mapping[str, float], load: float) -> Play:
            k = float(np.exp(values[f"ln k {joint}"]))
            free, lies = swing_rad * float(np.exp(values[half])), load if carries else 0.0
            inside = (1.0 - values[part]) * k
            # On a flank, or between both on what is left of the spring.
            rest = np.sign(lies) * (abs(lies) + values[part] * k * free) / k
            if abs(lies) < inside * free:
                rest = lies / inside
            return Play(
                stiffness=np.array([values[part] * k]),
                half=np.array([free]),
                rest=np.array([float(rest)]),
            )

        return law_instance(
            ordinary,
            WORDS,
            joint,
            swing_rad,
            rate_rad_s,
            parameters=(
                Parameter(name=part, unit="", mean=0.0, std=_STD, low=0.0, high=1.0),
                Parameter(
                    name=half,
                    unit="",
                    mean=_LN_HALF,
                    std=_LN_HALF_STD,
                    low=_LN_HALF_LEAST,
                    high=_LN_HALF_MOST,
                ),
            ),
            element=element,
            material=LEAST,
            starting_points=[
                {part: q, half: h}
                for q, h in ((0.4, 0.2), (0.3, -0.7), (0.3, -2.0), (1.0, -2.0), (1.0, -3.5))
            ],
            words_of_it={"rests": "on the side its weight lays it to" if carries else "between"},
        )

    loaded = joint in {ordinary.arm.joints[i].name for i in ordinary.loaded}
    told = {part: "part of the joint's spring", half: "ln half play, over the middle swing"}
    return tuple(
        replace(at_rest(carries=carries), words=told)
        for carries in (False, True)
        if loaded or not carries
    )
