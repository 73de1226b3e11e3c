"""The next test that the gap workflow proposes, as a plan file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from protocols.errors import PlanError
from protocols.plan import plan_from_text
from protocols.plan_records import Mode, Sampling, Windows
from protocols.session.records import Session
from tui.plan import TOLERANCE_DEG

__all__ = ["next_test_plan"]


def next_test_plan(session: Session, found: Mapping[str, Any]) -> str:
    """Text of a plan that measures the proposed posture as the session was measured.

    Raises
    ------
    PlanError
        If no posture is proposed, or the arm cannot take it.
    """
    test = found.get("next_test")
    if isinstance(test, Sequence) and not isinstance(test, str) and test:
        test = test[0]
    if not isinstance(test, Mapping):
        raise PlanError(
            "wanted a next test with a posture, the gap result proposes none; nothing to plan"
        )
    plan, arm = session.header.plan, session.header.arm
    angles = _angles_deg(test)
    points = [str(p) for p in test.get("points") or plan.postures[0].points]
    fixed = str(test.get("hit_point") or plan.fixed_point)
    if plan.mode is Mode.ROVING_HAMMER:
        fixed = plan.fixed_point
    trigger = "rising" if plan.trigger.rising else "falling"
    lines = [
        "# The next test proposed by `armodal gap`. Format: docs/plan-file.md",
        'format = "armodal-plan-1"',
        'name = "next-test"',
        f"arm = {_quoted(arm.name)}",
        f'mode = "{plan.mode.value}"',
        f"fixed_point = {_quoted(fixed)}",
        f"hits_per_point = {plan.hits_per_point}",
        f"max_attempts = {plan.max_attempts}",
        f"sampling = {{ {_sampling(plan.sampling)} }}",
        f'trigger = {{ level_n = {plan.trigger.level_n}, slope = "{trigger}" }}',
        f"windows = {{ {_windows(plan.windows)} }}",
        f"sensor = {{ mass_kg = {plan.sensor.mass_kg} }}",
        "",
        "[[postures]]",
        'name = "next test"',
        "joints_deg = [" + ", ".join(f"{angle:.2f}" for angle in angles) + "]",
        f"tolerance_deg = {TOLERANCE_DEG}",
        "points = [" + ", ".join(_quoted(point) for point in points) + "]",
    ]
    direction = test.get("hit_direction")
    if isinstance(direction, Sequence) and len(direction) == 3:
        lines.append("hit_direction = [" + ", ".join(f"{x:.4f}" for x in direction) + "]")
    text = "\n".join(lines) + "\n"
    plan_from_text(text, arm, origin="next test")
    return text


def _angles_deg(test: Mapping[str, Any]) -> list[float]:
    for key, unit in (("joints_deg", 1.0), ("posture_deg", 1.0), ("joints_rad", 180.0 / math.pi)):
        value = test.get(key)
        if isinstance(value, Sequence) and not isinstance(value, str):
            return [unit * float(angle) for angle in value]
    raise PlanError(
        f"wanted joints_deg in the next test, it has {', '.join(map(str, test)) or 'nothing'}; "
        "write the plan by hand"
    )


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _sampling(sampling: Sampling) -> str:
    rate = sampling.rate_hz
    told = str(int(rate)) if rate.denominator == 1 else f'"{rate}"'
    return f"rate_hz = {told}, samples = {sampling.samples}, pretrigger = {sampling.pretrigger}"


def _windows(windows: Windows) -> str:
    told = f"exponential_end = {windows.exponential_end}"
    return told if windows.force_s is None else f"{told}, force_s = {windows.force_s}"
