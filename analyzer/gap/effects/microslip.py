"""A seat that slips little by little, more the larger the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.effects.level import COVERED, COVERED_HERE, LEAST
from armodal.analyzer.gap.effects.own_law import law_instance
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.joint_laws import Sliders
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "laws"]

_SLIDERS = 16  # a staircase of a law that is smooth, finest where soft hits and late swings slip
# Of the exponent 1 / (1 + chi) by which limits rise, chi that of their density. Loss by a power of
# the swing, 3 + chi, was measured between 2 and 3 (D. J. Segalman, J. Appl. Mech. 72 (2005) 752).
_SPREAD, _SPREAD_STD, _SPREAD_LEAST, _SPREAD_MOST = 0.35, 0.35, -1.0, 2.0
_STD = 0.8  # of ln of the stiffness while it holds over that while it slips
# Turn at which all have slipped, over a middle swing and over the part of the spring that slips:
# what is seen of a seat that never slips wholly is that ratio.
_LN_REACH, _LN_REACH_STD, _LN_REACH_LEAST, _LN_REACH_MOST = 0.6, 1.2, -4.0, 5.0

WORDS = EffectWords(
    name="microslip",
    title="Micro-slip in a seat or clamp of a joint",
    changes="a joint's stiffness falls with the hit's level while its damping grows",
    signature="harder hits see a softer joint with more damping",
    confused_with=("softening", "friction"),
    covers=COVERED,
    covers_here=COVERED_HERE,
    told_by="hits between soft and hard: damping has its maximum where stiffness falls most",
    remedy="retorque bolted seats and clamps of the joint's drive",
)


def laws(
    ordinary: Ordinary, joint: str, swing_rad: float, rate_rad_s: float
) -> tuple[Instance, ...]:
    """Sliders beside the joint's spring that slip one after the other.

    W. D. Iwan, J. Appl. Mech. 33 (1966) 893.
    """
    held, reach, spread = (
        f"ln {what} {joint}" for what in ("stiffer while held", "seat slips", "seat spread")
    )
    edges = (np.arange(_SLIDERS + 1) / _SLIDERS) ** 2
    share, order = np.diff(edges)[None], 0.5 * (edges[1:] + edges[:-1])[None]

    def element(values: Mapping[str, float], load: float) -> Sliders:
        del load
        k = share * np.expm1(values[held]) * np.exp(values[f"ln k {joint}"])
        turn = -np.expm1(-values[held]) * swing_rad * np.exp(values[reach])
        return Sliders(
            stiffness=k,
            limit=k * turn * order ** np.exp(values[spread]),
            creep_per_s=np.zeros(1),
        )

    only = law_instance(
        ordinary,
        WORDS,
        joint,
        swing_rad,
        rate_rad_s,
        parameters=(
            Parameter(name=held, unit="", mean=0.0, std=_STD, low=0.0),
            Parameter(
                name=reach,
                unit="",
                mean=_LN_REACH,
                std=_LN_REACH_STD,
                low=_LN_REACH_LEAST,
                high=_LN_REACH_MOST,
            ),
            Parameter(
                name=spread,
                unit="",
                mean=_SPREAD,
                std=_SPREAD_STD,
                low=_SPREAD_LEAST,
                high=_SPREAD_MOST,
                untold=0.0,
            ),
        ),
        element=element,
        material=LEAST,
        starting_points=[
            {held: h, reach: u, spread: _SPREAD} for h in (0.1, 0.5, 1.2) for u in (0.0, 1.5)
        ],
    )
    told = {
        held: "ln stiffness while the seat holds, over that while it slips",
        reach: "ln turn at which all slips, over that of a middle hit and the part that slips",
    }
    return (replace(only, words=told, details=(spread,)),)
