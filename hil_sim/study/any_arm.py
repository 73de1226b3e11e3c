"""Any arm in the laboratory: how hard one may hit it, and postures to rehearse it in."""

from __future__ import annotations

import json
from functools import partial

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.newton_euler import place
from armodal.hil_sim.plant import BASE, Plant, build_plant
from armodal.hil_sim.plant_file import PlantFile, PointTruth
from armodal.hil_sim.small_motion import force_torque, linearise
from armodal.hil_sim.streams import Streams, stream
from armodal.hil_sim.study.arms import StudyArm
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Mode, Plan

__all__ = ["can_size", "rehearsal_plan", "study_of"]

Array = npt.NDArray[np.float64]

# Of the hand, times the trigger level: good hits are well above it, and as hard as the shipped
# plans ask for (ur5: 4 N for hits of 12 to 28 N).
HAND = (3.0, 6.0)
LADDER = (1.5, 4.5, 11.0)
# How hard a person would hit: 2 N for each kg that moves, and no harder than lets the sensor reach
# a third of its range on the driving point moved as a free body.
N_PER_KG = 2.0
PART_OF_RANGE = 0.33
POSTURES, VALIDATIONS = 3, 2
DRAWS, DIRECTIONS = 200, 60
LARGEST_TURN_RAD = np.radians(120.0)  # from the middle of a range
PART_OF_HALF_RANGE = 0.6


def study_of(arm: Arm, plan: Plan | None = None) -> StudyArm:
    """Return an arm as a study has it; the hand hits as the plan's trigger level asks.

    Parameters
    ----------
    plan
        What the arm is measured by. Effects are sized by a plan of the laboratory's own where this
        one has no fixed hammer, no directions, or no posture for validation.

    Raises
    ------
    PlantError
        If the arm has no joint with a stiffness, or no test point on a moving link.
    """
    sizing = plan if plan is not None and can_size(plan) else rehearsal_plan(arm)
    level_n = (plan or sizing).trigger.level_n
    return StudyArm(
        arm=arm,
        plan=sizing,
        peak_n=(HAND[0] * level_n, HAND[1] * level_n),
        ladder_n=tuple(factor * level_n for factor in LADDER),
    )


def can_size(plan: Plan) -> bool:
    """Whether a plan has a fixed hammer with directions, and postures of both kinds."""
    directed = all(posture.hit_direction is not None for posture in plan.postures)
    kinds = {posture.validation for posture in plan.postures}
    return plan.mode is Mode.ROVING_RESPONSE and directed and len(kinds) == 2


def rehearsal_plan(arm: Arm) -> Plan:
    """Draw a plan for an arm: the same one every time.

    Five postures within the ranges, two of them for validation, as far above the mounting plane as
    a few hundred draws find; a fixed hammer on the last link with a point, its directions chosen so
    that every joint with a stiffness answers; all points.

    Raises
    ------
    PlantError
        As `study_of`.
    """
    springs = [None if j.stiffness is None else j.stiffness.value for j in arm.joints]
    dampers = [None if j.damping is None else j.damping.value for j in arm.joints]
    springs = [None if c is None else k for k, c in zip(springs, dampers, strict=True)]
    dampers = [None if k is None else c for k, c in zip(springs, dampers, strict=True)]
    if all(k is None for k in springs):
        raise PlantError(
            f"arm {arm.name}: wanted a joint with stiffness and damping, got none; the laboratory "
            "needs stiffness_n_m_per_rad and damping_n_m_s_per_rad of one joint at least"
        )
    truth = plant_file_of_arm(arm, springs, dampers, peak_n=(1.0, 2.0))
    plant = build_plant(truth)
    hit = _driving_point(truth)
    streams = partial(stream, 0, "rehearsal", arm.name)
    postures = _postures(plant, streams)
    directions = [_direction(plant, hit, q, streams) for q in postures]
    level_n = _level_n(plant, hit, postures, directions)
    return plan_from_text(_text(arm, hit.id, postures, directions, level_n), arm)


def _driving_point(truth: PlantFile) -> PointTruth:
    links = [link.name for link in truth.links]
    moving = [point for point in truth.points if point.link in links]
    if not moving:
        raise PlantError(
            f"arm {truth.name}: wanted a test point on a moving link, got none; add one to be hit"
        )
    return max(moving, key=lambda point: links.index(point.link))


def _postures(plant: Plant, streams: Streams) -> list[Array]:
    """Each the first of some draws that clears the mounting plane, else the highest."""
    low, high = np.radians([link.range_deg for link in plant.truth.links]).T
    reach = np.minimum(PART_OF_HALF_RANGE * (high - low) / 2.0, LARGEST_TURN_RAD)
    found = []
    for number in range(POSTURES + VALIDATIONS):
        turns = streams("posture", number).uniform(-1.0, 1.0, (DRAWS, len(low)))
        drawn = (low + high) / 2.0 + reach * turns
        height_m = _lowest_m(plant, drawn)
        clear = height_m > 0.0
        found.append(drawn[np.argmax(clear) if np.any(clear) else np.argmax(height_m)])
    return [np.radians(np.round(np.degrees(q), 1)) for q in found]


def _lowest_m(plant: Plant, joints_rad: Array) -> Array:
    """(n,) heights over the mounting plane of the lowest point beyond the first link."""
    at = place(plant.chain, joints_rad)
    heights = [
        (at.origin_m[:, p.body] + at.R[:, p.body] @ p.position_m)[:, 2]
        for p in plant.points.values()
        if p.body not in (BASE, plant.joints[0])
    ]
    lowest: Array = np.min(heights, axis=0) if heights else np.ones(len(joints_rad))
    return lowest


def _direction(plant: Plant, hit: PointTruth, q: Array, streams: Streams) -> Array:
    """Into the surface, so that the joint that answers least answers most."""
    motion = linearise(plant, q, None)
    body = plant.point(hit.id).body
    normal = motion.at.R[body] @ np.array(hit.normal)
    inertia = np.sqrt(np.diag(motion.mass))
    best, most = -normal, -1.0
    for v in streams("direction", *(f"{a:.3f}" for a in q)).standard_normal((DIRECTIONS, 3)):
        force = -normal + 0.9 * v / np.linalg.norm(v)
        force /= np.linalg.norm(force)
        torque = force_torque(plant, motion.at, body, np.array(hit.position_m), force)
        least = float(np.min(np.abs(torque) / inertia))
        if least > most:
            best, most = force, least
    rounded: Array = np.round(best, 3)
    return rounded


def _level_n(plant: Plant, hit: PointTruth, postures: list[Array], along: list[Array]) -> float:
    """Trigger level for hits that fit the arm's mass and the sensor's range."""
    accelerometer, board = plant.truth.accelerometer, plant.truth.board
    reachable_m_s2 = PART_OF_RANGE * board.range_v / accelerometer.sensitivity_v_per_m_s2
    lightest_kg = np.inf
    for q, direction in zip(postures, along, strict=True):
        motion = linearise(plant, q, None)
        body = plant.point(hit.id).body
        torque = force_torque(plant, motion.at, body, np.array(hit.position_m), direction)
        lightest_kg = min(lightest_kg, 1.0 / float(torque @ np.linalg.solve(motion.mass, torque)))
    arm_kg = sum(link.mass_kg for link in plant.truth.links)
    peak_n = min(N_PER_KG * arm_kg, reachable_m_s2 * lightest_kg)
    return float(f"{peak_n / np.sqrt(HAND[0] * HAND[1]):.2g}")


def _text(
    arm: Arm, hit: str, postures: list[Array], directions: list[Array], level_n: float
) -> str:
    lines = [
        'format = "armodal-plan-1"',
        f'name = "{arm.name[:54]}-rehearsal"',
        f"arm = {json.dumps(arm.name)}",
        'mode = "roving-response"',
        f"fixed_point = {json.dumps(hit)}",
        "hits_per_point = 3",
        "max_attempts = 12",
        "[sampling]",
        'rate_hz = "51200/31"',
        "samples = 2048",
        "pretrigger = 100",
        "[trigger]",
        f"level_n = {level_n}",
        'slope = "rising"',
        "[windows]",
        "exponential_end = 0.03",
        "[sensor]",
        "mass_kg = 0.0093",
    ]
    points = json.dumps([point.id for point in arm.points])
    for number, (q, direction) in enumerate(zip(postures, directions, strict=True), 1):
        lines += [
            "[[postures]]",
            f'name = "posture {number}"',
            f"joints_deg = {np.round(np.degrees(q), 1).tolist()}",
            "tolerance_deg = 0.5",
            f"points = {points}",
            f"hit_direction = {direction.tolist()}",
        ]
        if number > POSTURES:
            lines.append("validation = true")
    return "\n".join(lines) + "\n"
