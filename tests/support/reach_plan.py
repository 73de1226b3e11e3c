"""The plan of sessions that are run for their devices' sake: one posture of a UR5."""

from __future__ import annotations

import json
from collections.abc import Sequence

from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Plan

_TEXT = """
format = "armodal-plan-1"
name = "reach"
arm = "ur5"
mode = "roving-response"
fixed_point = "1"
hits_per_point = {hits}
max_attempts = {attempts}
[sampling]
rate_hz = {rate_hz}
samples = {samples}
pretrigger = {pretrigger}
[trigger]
level_n = 20.0
slope = "rising"
[windows]
exponential_end = 0.03
[sensor]
mass_kg = 0.0093
[[postures]]
name = "reach"
joints_deg = [15.0, -30.0, 40.0, -60.0, -70.0, 20.0]
tolerance_deg = 0.5
points = {points}
hit_direction = [-0.45, -0.62, -0.64]
"""


def reach_text(
    *,
    rate_hz: int | str,
    samples: int,
    pretrigger: int,
    points: Sequence[str] = ("2", "3", "4", "5"),
    hits: int = 100,
    attempts: int = 100,
) -> str:
    """Return the plan's file."""
    return _TEXT.format(
        rate_hz=json.dumps(rate_hz),
        samples=samples,
        pretrigger=pretrigger,
        points=json.dumps(list(points)),
        hits=hits,
        attempts=attempts,
    )


def reach_plan(*, rate_hz: int | str, samples: int, pretrigger: int) -> Plan:
    """Return the plan of hits without end."""
    text = reach_text(rate_hz=rate_hz, samples=samples, pretrigger=pretrigger)
    return plan_from_text(text, load_arm("ur5"))
