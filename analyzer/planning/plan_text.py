"""A plan file of the tests that were found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.planning.equipment import Chosen
from armodal.analyzer.planning.measured_points import measured_points
from armodal.analyzer.planning.route import Leg
from armodal.analyzer.planning.selective import PlannedTest, SelectivePlan
from armodal.protocols.plan import plan_from_text

__all__ = ["plan_text"]

TOLERANCE_DEG = 0.5
TRIGGER_N, SENSOR_KG = 10.0, 0.01  # where nothing is known of the equipment


def plan_text(
    plan: SelectivePlan,
    name: str,
    *,
    points: Sequence[Sequence[str]] | None = None,
    equipment: Chosen | None = None,
    legs: Sequence[Leg] | None = None,
) -> str:
    """A plan file of the tests.

    Parameters
    ----------
    points
        Measured in each test; else all that a hand reaches (`measured_points`).
    equipment
        What the plan is measured with; else a light hammer and sensor.
    legs
        The ways from test to test, which stand as comments.

    Raises
    ------
    PlanError
        If the text would not be a valid plan for the arm.
    """
    top_hz = max(float(test.modes.f_hz.max()) for test in plan.tests)
    rate_hz = next((rate for rate in (1024, 2048, 4096, 8192) if rate > 4 * top_hz), 16384)
    trigger = TRIGGER_N if equipment is None else equipment.trigger_n
    sensor = SENSOR_KG if equipment is None else equipment.accelerometer.mass_kg
    told = "" if equipment is None else _told(equipment)
    head = f"""# Made by `armodal plan`. Format: docs/plan-file.md
{told}format = "armodal-plan-1"
name = "{name}"
arm = "{plan.arm.name}"
mode = "roving-response"
fixed_point = "{plan.hit_point}"
hits_per_point = 3
max_attempts = 10
sampling = {{ rate_hz = {rate_hz}, samples = {2 * rate_hz}, pretrigger = {rate_hz // 16} }}
trigger = {{ level_n = {trigger}, slope = "rising" }}
sensor = {{ mass_kg = {sensor} }}
"""
    text = head
    if points is None:
        points = measured_points(plan)
    for number, test in enumerate(plan.tests, start=1):
        if legs is not None and number > 1:
            text += _way(legs[number - 2], number)
        text += _posture_table(number, test, points[number - 1], validation=number > plan.n_fitted)
    plan_from_text(text, plan.arm, origin="plan made")
    return text


def _told(equipment: Chosen) -> str:
    hammer, sensor = equipment.hammer, equipment.accelerometer
    return (
        f"# Hammer: {hammer.name}, head {hammer.head_kg:g} kg; tip with a pulse of "
        f"{1e3 * equipment.pulse_s:.2g} ms; hits of some {equipment.told_peak_n} N.\n"
        f"# Accelerometer: {sensor.name}, {1e3 * sensor.mass_kg:g} g, to {sensor.range_m_s2:g} "
        f"m/s².\n# Of: {equipment.source}.\n"
    )


def _way(leg: Leg, number: int) -> str:
    if leg.stops_rad is None:
        return (
            f"\n# To test {number} no free way was found that turns all joints at once: move joint "
            "by joint, and look."
        )
    stops = ", then by ".join(_angles(stop) for stop in leg.stops_rad)
    return f"\n# To test {number} go by {stops} degrees." if stops else ""


def _angles(joints_rad: npt.NDArray[np.float64]) -> str:
    return "[" + ", ".join(f"{angle:.2f}" for angle in np.rad2deg(joints_rad)) + "]"


def _posture_table(
    number: int, test: PlannedTest, points: Sequence[str], *, validation: bool
) -> str:
    direction = ", ".join(f"{value:.4f}" for value in test.hit.direction_base)
    listed = ", ".join(f'"{point}"' for point in points)
    held_out = "validation = true\n" if validation else ""
    return f"""
[[postures]]
name = "test {number}"
joints_deg = {_angles(test.joints_rad)}
tolerance_deg = {TOLERANCE_DEG}
points = [{listed}]
hit_direction = [{direction}]
{held_out}"""
