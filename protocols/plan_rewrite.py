"""The proposed next test: a plan file with one posture of its own, or with hits at levels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import tomlkit
from tomlkit.exceptions import TOMLKitError

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Plan, PlannedPosture

__all__ = ["text_with_peaks", "text_with_posture"]

_LONGEST_NAME = 64
# Of the softest hit that is wanted: hits below two trigger levels are judged too soft.
_TRIGGER_PART = 0.4


def text_with_posture(
    plan: Plan,
    arm: Arm,
    posture: PlannedPosture,
    *,
    comment: str,
    fixed_point: str | None = None,
) -> str:
    """Return a plan's text with one posture alone, under another name and for the arm at hand.

    The rest is as it was. Only where the posture wants peaks may hits and attempts per point be
    more, to take one hit a peak, and the trigger level lower, to see the softest.

    Parameters
    ----------
    posture
        It is never written as one for validation: a plan needs one that is not. A joint beyond its
        range by less than the tolerance, as a measured angle may be, is put at the range's end.
    comment
        One line of what the test is for.
    fixed_point
        Another than the plan's.

    Raises
    ------
    PlanError
        If the posture is not possible for the arm, or the plan's text cannot be read again.
    """
    document = _parsed(plan)
    table = tomlkit.table()
    table["name"] = posture.name
    table["joints_deg"] = _degrees(posture, arm)
    table["tolerance_deg"] = round(math.degrees(posture.tolerance_rad), 6)
    table["points"] = list(posture.points)
    if posture.hit_direction is not None:
        table["hit_direction"] = [round(float(x), 4) for x in posture.hit_direction]
    if posture.brakes:
        table["brakes"] = True
    if posture.known_mass is not None:
        body = tomlkit.inline_table()
        body["link"] = posture.known_mass.link
        body["mass_kg"] = posture.known_mass.mass_kg
        body["center_m"] = [round(float(x), 4) for x in posture.known_mass.center_m]
        table["known_mass"] = body
    if posture.peaks_n:
        _ask_for(document, table, posture.peaks_n, plan)
    postures = tomlkit.aot()
    postures.append(table)
    document.pop("postures", None)
    if fixed_point is not None:
        document["fixed_point"] = fixed_point
    document["postures"] = postures
    return _checked(document, plan, arm, comment)


def text_with_peaks(plan: Plan, arm: Arm, peaks_n: Sequence[float], *, comment: str) -> str:
    """Return a plan's text with peak forces in N that are wanted at every point, in turn.

    It has another name and is for the arm at hand. Hits and attempts per point may be more, to take
    one hit a peak, and the trigger level lower, to see the softest. The rest is as it was.

    Raises
    ------
    PlanError
        If the plan or a peak is not possible for the arm, or its text cannot be read again.
    """
    document = _parsed(plan)
    for table in document["postures"]:
        _ask_for(document, table, peaks_n, plan)
    return _checked(document, plan, arm, comment)


def _parsed(plan: Plan) -> dict[str, Any]:
    try:
        return tomlkit.parse(plan.text)
    except TOMLKitError as problem:
        raise PlanError(f"the session's plan cannot be read again: {problem}") from problem


def _ask_for(
    document: dict[str, Any], table: dict[str, Any], peaks_n: Sequence[float], plan: Plan
) -> None:
    table["peaks_n"] = [round(float(x), 1) for x in peaks_n]
    hits = max(plan.hits_per_point, len(peaks_n))
    document["hits_per_point"] = hits
    document["max_attempts"] = max(plan.max_attempts, hits)
    level_n = _TRIGGER_PART * min(peaks_n)
    if level_n < plan.trigger.level_n:
        document["trigger"] = {**document["trigger"], "level_n": round(level_n, 2)}


def _checked(document: dict[str, Any], plan: Plan, arm: Arm, comment: str) -> str:
    document["name"] = f"{plan.name}-next"[-_LONGEST_NAME:].lstrip("-_")
    # The session may be judged with another file of the same arm.
    document["arm"] = arm.name
    text = f"# {comment}\n{tomlkit.dumps(document)}"
    plan_from_text(text, arm, origin="proposed plan")
    return text


def _degrees(posture: PlannedPosture, arm: Arm) -> list[float]:
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    within = np.clip(posture.joints_rad, low, high)
    is_near = np.abs(within - posture.joints_rad) <= posture.tolerance_rad
    # What is further off stays as it is and is refused: it would be another posture.
    angles_rad = np.where(is_near, within, posture.joints_rad)
    return [round(math.degrees(float(angle)), 2) for angle in angles_rad]
