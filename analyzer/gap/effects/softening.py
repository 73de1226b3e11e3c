"""A joint that is softer, or harder, for larger motion, without a loss of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.effects.level import COVERED, COVERED_HERE, LEAST
from armodal.analyzer.gap.effects.own_law import law_instance
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.joint_laws import Bent
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "laws"]

_STD, _HARDEST, _SOFTEST = 0.5, -20.0, 0.95  # likewise; all of it but a twentieth is lost at most
_LN_BEND_STD, _LN_BEND_LEAST, _LN_BEND_MOST = 1.0, -2.5, 2.0

WORDS = EffectWords(
    name="softening",
    title="Joint softens or hardens with larger motion",
    changes="a joint's stiffness falls (or grows) with the hit's level; its damping stays",
    signature="frequencies fall (or rise) with harder hits, damping does not change",
    confused_with=("microslip", "friction", "backlash"),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="hits between soft and hard: their frequencies and damping",
    remedy="give the joint's stiffness at the level of use; look at preloads that open",
)


def laws(
    ordinary: Ordinary, joint: str, swing_rad: float, rate_rad_s: float
) -> tuple[Instance, ...]:
    """A spring that is softer (or harder, where that is negative) for larger turns, no loss."""
    part, bend = f"softer {joint}", f"ln bend {joint}"

    def element(values: Mapping[str, float], load: float) -> Bent:
        del load
        a = np.exp(values[bend])
        k = np.exp(values[f"ln k {joint}"])
        return Bent(
            part=np.array([-values[part] * (1.0 + a**2) * k]), bend=np.array([a * swing_rad])
        )

    only = law_instance(
        ordinary,
        WORDS,
        joint,
        swing_rad,
        rate_rad_s,
        parameters=(
            Parameter(name=part, unit="", mean=0.0, std=_STD, low=_HARDEST, high=_SOFTEST),
            Parameter(
                name=bend,
                unit="",
                mean=0.0,
                std=_LN_BEND_STD,
                low=_LN_BEND_LEAST,
                high=_LN_BEND_MOST,
            ),
        ),
        element=element,
        material=LEAST,
        starting_points=[
            {part: q, bend: b}
            for q, b in (
                (0.1, 1.5),
                (0.1, 0.0),
                (0.3, -1.0),
                (0.5, 0.0),
                (-0.2, 1.5),
                (-1.0, 1.5),
                (-5.0, 1.5),
            )
        ],
    )
    told = {
        part: "part of the joint's stiffness lost at the middle swing",
        bend: "ln turn where it bends, over the middle swing",
    }
    return (replace(only, words=told),)
