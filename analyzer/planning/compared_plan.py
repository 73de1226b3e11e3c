"""Another plan beside the one that was found: how selective its postures are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.planning.equations import PlannedArm
from armodal.analyzer.planning.selectivity import worst_coupling
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import load_plan, shipped_plans
from armodal.protocols.plan_records import Plan

__all__ = ["ComparedPlan", "plan_to_compare"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedPlan:
    """For each elastic joint the least coupled posture of another plan."""

    name: str
    postures: tuple[str, ...]  # (n,) names
    least_coupling: Array  # (n,)


def plan_to_compare(planned: PlannedArm, source: str | None) -> ComparedPlan | None:
    """The plan to set beside: the one named, else this arm's shipped one of most postures.

    Raises
    ------
    PlanError
        If the plan named cannot be read, or is for another arm.
    """
    arm = planned.arm
    plan = load_plan(source, arm) if source is not None else _shipped(arm)
    if plan is None:
        return None
    postures = np.stack([posture.joints_rad for posture in plan.postures])
    worst = worst_coupling(planned.joint_mass(postures))
    best = worst.argmin(axis=1)
    return ComparedPlan(
        name=plan.name,
        postures=tuple(plan.postures[i].name for i in best),
        least_coupling=worst.min(axis=1),
    )


def _shipped(arm: Arm) -> Plan | None:
    found = []
    for name in shipped_plans():
        try:
            found.append(load_plan(name, arm))
        except PlanError:  # for another arm
            continue
    return max(found, key=lambda plan: len(plan.postures), default=None)
