"""A plan file of the tests that were found."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.planning.selective import PlannedTest, SelectivePlan
from armodal.protocols.plan import plan_from_text

__all__ = ["plan_text"]

TOLERANCE_DEG = 0.5


def plan_text(plan: SelectivePlan, name: str) -> str:
    """A plan file of the tests.

    Raises
    ------
    PlanError
        If the text would not be a valid plan for the arm.
    """
    top_hz = max(float(test.modes.f_hz.max()) for test in plan.tests)
    rate_hz = next((rate for rate in (1024, 2048, 4096, 8192) if rate > 4 * top_hz), 16384)
    head = f"""# Made by `armodal plan`. Format: docs/plan-file.md
format = "armodal-plan-1"
name = "{name}"
arm = "{plan.arm.name}"
mode = "roving-response"
fixed_point = "{plan.hit_point}"
hits_per_point = 3
max_attempts = 10
sampling = {{ rate_hz = {rate_hz}, samples = {2 * rate_hz}, pretrigger = {rate_hz // 16} }}
trigger = {{ level_n = 10.0, slope = "rising" }}
sensor = {{ mass_kg = 0.01 }}
"""
    moving = [point.id for point in plan.arm.points if point.link != "base"]
    text = head + "".join(
        _posture_table(number, test, moving) for number, test in enumerate(plan.tests, start=1)
    )
    plan_from_text(text, plan.arm, origin="plan made")
    return text


def _posture_table(number: int, test: PlannedTest, points: list[str]) -> str:
    angles = ", ".join(f"{angle:.2f}" for angle in np.rad2deg(test.joints_rad))
    direction = ", ".join(f"{value:.4f}" for value in test.hit.direction_base)
    listed = ", ".join(f'"{point}"' for point in points)
    return f"""
[[postures]]
name = "test {number}"
joints_deg = [{angles}]
tolerance_deg = {TOLERANCE_DEG}
points = [{listed}]
hit_direction = [{direction}]
"""
