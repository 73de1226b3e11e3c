"""The arms of the study: shipped arm files, their plans, and how hard one may hit them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan import load_plan
from armodal.protocols.plan_records import Plan

__all__ = ["STUDY_ARMS", "StudyArm", "compliance_of", "study_arm"]


def compliance_of(springs: Sequence[float]) -> float:
    """Geometric mean of the first three springs' compliance in rad / N m."""
    return float(np.exp(-np.mean(np.log(springs[:3]))))


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyArm:
    """An arm as its user believes it, and a plan with postures for validation."""

    arm: Arm
    plan: Plan
    peak_n: tuple[float, float]
    ladder_n: tuple[float, ...]  # peaks of a hit-level ladder

    @property
    def joint_compliance(self) -> float:
        """Geometric mean of the first three joints' compliance in rad / N m."""
        return compliance_of(
            [joint.stiffness.value for joint in self.arm.joints if joint.stiffness]
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Entry:
    plan: str
    peak_n: tuple[float, float]
    ladder_n: tuple[float, ...]


STUDY_ARMS = {
    "bench57": _Entry(
        plan="bench57-five-postures", peak_n=(30.0, 70.0), ladder_n=(15.0, 45.0, 130.0)
    ),
    "ur5": _Entry(plan="ur5-five-postures", peak_n=(12.0, 28.0), ladder_n=(6.0, 18.0, 45.0)),
    "rv4frl": _Entry(
        plan="rv4frl-three-postures", peak_n=(40.0, 90.0), ladder_n=(20.0, 55.0, 140.0)
    ),
}


@cache
def study_arm(name: str) -> StudyArm:
    """Return one of the study's arms by name.

    Raises
    ------
    PlantError
        If the study has no arm of that name.
    """
    if name not in STUDY_ARMS:
        raise PlantError(
            f"no arm of the study is called {name!r}; wanted one of {', '.join(STUDY_ARMS)}"
        )
    entry = STUDY_ARMS[name]
    arm = load_arm(name)
    return StudyArm(
        arm=arm,
        plan=load_plan(entry.plan, arm),
        peak_n=entry.peak_n,
        ladder_n=entry.ladder_n,
    )
