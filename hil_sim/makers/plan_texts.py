"""The plan of a case: five postures, the last two for validation."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable, Array
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Mode, Plan

__all__ = ["Campaign", "planned"]

N_DIRECTIONS = 200  # tried over the sphere, some 12 degrees from one to the next


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """How a laboratory measures."""

    mode: Mode
    rate_hz: str
    samples: int
    pretrigger: int
    hits_per_point: int
    sensor_kg: float
    trigger_n: float


def planned(table: ArmTable, arm: Arm, campaign: Campaign) -> Plan:
    """Return the plan of an arm's five postures and eighteen points."""
    points = [point.id for point in arm.points]
    lines = [
        'format = "armodal-plan-1"',
        f'name = "{table.name}-five-postures"',
        f'arm = "{table.name}"',
        f'mode = "{campaign.mode.value}"',
        f'fixed_point = "{points[0]}"',
        f"hits_per_point = {campaign.hits_per_point}",
        f"max_attempts = {4 * campaign.hits_per_point}",
        "[sampling]",
        f'rate_hz = "{campaign.rate_hz}"',
        f"samples = {campaign.samples}",
        f"pretrigger = {campaign.pretrigger}",
        "[trigger]",
        f"level_n = {campaign.trigger_n}",
        'slope = "rising"',
        "[sensor]",
        f"mass_kg = {campaign.sensor_kg}",
    ]
    for number, joints_deg in enumerate(table.postures_deg):
        lines += [
            "[[postures]]",
            f'name = "posture {number + 1}"',
            f"joints_deg = {json.dumps(joints_deg)}",
            "tolerance_deg = 0.5",
            f"points = {json.dumps(points)}",
            f"validation = {json.dumps(number >= len(table.postures_deg) - 2)}",
        ]
        if campaign.mode is Mode.ROVING_RESPONSE:
            direction = _telling_direction(arm, np.deg2rad(joints_deg), points[0])
            lines.append("hit_direction = [" + ", ".join(f"{d:.3f}" for d in direction) + "]")
    return plan_from_text("\n".join(lines) + "\n", arm)


def _telling_direction(arm: Arm, joints_rad: Array, point_id: str) -> Array:
    """Direction of a hit that loads every elastic joint: the largest of the smallest moments."""
    point = arm.point(point_id)
    T = link_pose(arm, point.link, joints_rad)
    at = T[:3, :3] @ point.position_m + T[:3, 3]
    moments = []
    for joint in arm.joints:
        pose = link_pose(arm, joint.link.name, joints_rad)
        if joint.stiffness is not None:
            lever = np.cross(pose[:3, :3] @ joint.axis, at - pose[:3, 3])
            moments.append(lever / max(float(np.linalg.norm(lever)), 1e-9))
    steps = np.arange(N_DIRECTIONS) + 0.5
    z, turn = 1.0 - 2.0 * steps / N_DIRECTIONS, steps * np.pi * (1.0 + np.sqrt(5.0))
    sphere = np.column_stack(
        [np.sqrt(1.0 - z**2) * np.cos(turn), np.sqrt(1.0 - z**2) * np.sin(turn), z]
    )
    weakest = np.min(np.abs(sphere @ np.array(moments).T), axis=1)
    inwards = sphere @ (T[:3, :3] @ point.R_link_sensor[:, 2]) < -0.3  # a hammer comes from outside
    chosen: Array = sphere[int(np.argmax(np.where(inwards, weakest, -1.0)))]
    return chosen
