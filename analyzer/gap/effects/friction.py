"""Dry friction in a joint: it holds back a part of the torque, whatever the motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.effects.level import COVERED, COVERED_HERE
from armodal.analyzer.gap.effects.own_law import law_instance
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.joint_laws import Sliders
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "laws"]

# Of the moment a hit of the middle level puts on the joint: as a damper a ratio of 2 / pi of that,
# a tenth of a drive's 2 %.
_LEAST = 0.003
_LIMIT_STD, _LIMIT_MOST = 0.5, 3.0  # of the same moment
# Spring before it slips, over the joint's.
_LN_BEFORE, _LN_BEFORE_STD, _LN_BEFORE_LEAST, _LN_BEFORE_MOST = np.log(5.0), 1.5, -1.5, np.log(1e3)
_CREEP_STD, _CREEP_MOST = 300.0, 3000.0  # 1/s

WORDS = EffectWords(
    name="friction",
    title="Dry friction in a joint",
    changes="a joint's damping falls with the hit's level, its stiffness too or not at all",
    signature="softer hits see a stiffer joint with more damping; it sticks as it dies away",
    confused_with=("microslip", "softening"),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="more levels, and the decay of one hard hit in windows",
    remedy="look at seals, brakes and the preload of the gear; test at the level of use",
)


def laws(
    ordinary: Ordinary, joint: str, swing_rad: float, rate_rad_s: float
) -> tuple[Instance, ...]:
    """Coulomb's law behind a spring that gives way before it slips (a Jenkins element).

    Where a film shears below the limit, or a simulator's friction yields to low speed, it creeps.
    """
    limit, before, creep = f"limit {joint}", f"ln presliding {joint}", f"creep {joint}"
    moment = ordinary.stiffness(joint) * swing_rad

    def element(values: Mapping[str, float], load: float) -> Sliders:
        del load
        k = np.exp(values[f"ln k {joint}"] + values[before])
        return Sliders(
            stiffness=np.array([[k]]),
            limit=np.array([[values[limit]]]),
            creep_per_s=np.array([values[creep]]),
        )

    only = law_instance(
        ordinary,
        WORDS,
        joint,
        swing_rad,
        rate_rad_s,
        parameters=(
            Parameter(
                name=limit,
                unit="N m",
                mean=0.0,
                std=_LIMIT_STD * moment,
                low=0.0,
                high=_LIMIT_MOST * moment,
            ),
            # At the upper end it gives way by a thousandth of the joint: a seal without presliding.
            Parameter(
                name=before,
                unit="",
                mean=_LN_BEFORE,
                std=_LN_BEFORE_STD,
                low=_LN_BEFORE_LEAST,
                high=_LN_BEFORE_MOST,
            ),
            Parameter(name=creep, unit="1/s", mean=0.0, std=_CREEP_STD, low=0.0, high=_CREEP_MOST),
        ),
        element=element,
        material=_LEAST * moment,
        starting_points=[
            {limit: part * moment, before: ratio, creep: rate}
            for part in (_LEAST, 0.01, 0.03, 0.1, 0.3)
            for ratio, rate in (
                (0.0, 0.0),
                (np.log(10.0), 0.0),
                (np.log(30.0), 500.0),
                (np.log(300.0), 0.0),
            )
        ],
    )
    return (only,)
