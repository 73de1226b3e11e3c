"""The session's own plan once more, hit softly, as before and hard."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from armodal.analyzer.gap.decision.without_levels import ALIKE, titles
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.records import NextTest
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import Plan
from armodal.protocols.plan_rewrite import text_with_peaks

__all__ = ["hits_at_levels"]

_SOFTER, _HARDER = 3.0, 2.5  # than hits are as they come


def hits_at_levels(stage: Stage, arm: Arm, standing: Sequence[Fit], plan: Plan) -> NextTest:
    """The session's own plan once more, every point hit softly, as before and hard.

    Parameters
    ----------
    standing
        What it tells apart; nothing where no model explains the session, and a joint that changes
        with the level is what was not looked for.

    Raises
    ------
    PlanError
        If the plan is not possible for the arm the session is judged with.
    """
    middle = float(np.exp(np.mean([np.log(own.peak_n) for own in stage.lines])))
    peaks_n = (middle / _SOFTER, middle, middle * _HARDER)
    why = f"tells apart: {titles(standing)}" if standing else f"shows whether {ALIKE} is missing"
    told = ", ".join(f"{peak:.0f}" for peak in peaks_n)
    return NextTest(
        words=f"measure the whole plan again, every point with hits of about {told} N",
        why=why,
        gain=None,
        plan_toml=text_with_peaks(plan, arm, peaks_n, comment=f"Proposed: {why}"),
    )
