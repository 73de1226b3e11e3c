"""What is ordinarily wrong with an arm and its test: drawn for every case, nulls included.

Each cause has its stream. The ranges are this maker's own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable, Array, Inertial
from armodal.hil_sim.makers.belief import Believed, urdf_text
from armodal.hil_sim.makers.mujoco.machine import Axis, Body, Machine, Place, read_machine
from armodal.hil_sim.makers.mujoco.split import outer_half
from armodal.hil_sim.makers.shell_points import shell_points
from armodal.hil_sim.streams import stream

__all__ = ["Bench", "Ordinary", "ordinary"]

Streams = Callable[..., np.random.Generator]

# By cause: the interval it is drawn from, evenly; evenly in the logarithm where both are positive
# and a factor of more than four apart.
TOLERANCES = {
    "mass": (0.02, 0.05),
    "inertia": (0.03, 0.08),
    "center_m": (0.0015, 0.004),
    "encoder_offset_deg": (0.04, 0.2),
    "sensor_tilt_deg": (0.6, 2.2),
    "sensor_gain": (0.004, 0.01),
    "hammer_gain": (0.005, 0.015),
    "hit_direction_deg": (1.0, 3.0),
}
DRIVE_SCATTER = 0.25  # of ln k about a data sheet's value
DRIVE_DOUBT = 0.35  # relative std that the arm file states
DAMPING_RATIO = (0.01, 0.045)  # of a joint alone
BEARING_COMPLIANCE = (0.0007, 0.024)  # of its drive's
BASE_COMPLIANCE = (0.0002, 0.0095)  # of the drive's of joint 1
LINK_COMPLIANCE = (0.0002, 0.011)  # of the drive's that carries it, about each axis across
LOSS_TIME_S = (3e-6, 6.5e-4)  # damping over stiffness of bearings, base and links
POINT_ERROR_M = (0.0008, 0.003)
BLOW_SPREAD_M = (0.001, 0.004)
NOISE_M_S2 = (0.0015, 0.009)
NOISE_OF_PEAK = (1e-4, 6e-4)  # force noise over the soft hits' peak
HIGHPASS_HZ = (0.15, 0.8)
PULSE_S = (0.0028, 0.0062)


@dataclass(slots=True, kw_only=True)
class Bench:
    """Sensors, hammer and hand; faults of the measurement edit it."""

    sensor: Array  # (3, 3) what the sensor tells of what it feels
    tilt_rad: float
    aim_rad: float
    blow_m: float
    noise_m_s2: float
    noise_n: float
    highpass_hz: float
    pulse_s: float
    hammer_gain: float
    point_sensor: dict[str, Array] = field(default_factory=dict)  # (3, 3) on top, by point
    late_s: float = 0.0  # of the response against the force
    window_end: float = 1.0
    turned_hits: dict[str, Array] = field(default_factory=dict)  # (3, 3) by posture
    stands_at: dict[str, str] = field(default_factory=dict)
    extra_kg: float = 0.0  # of the sensor above what the plan says


@dataclass(frozen=True, slots=True, kw_only=True)
class Ordinary:
    """An arm with its ordinary errors, and what the laboratory believes of it."""

    table: ArmTable
    machine: Machine
    bench: Bench
    elastic: tuple[str, ...]  # joints
    offsets_rad: dict[str, float]  # true angle less the controller's
    tolerances: dict[str, float]
    stiffness: dict[str, Believed]
    damping: dict[str, Believed]
    loose: dict[str, float]  # std of the ordinary compliance of each axis that is no drive's


def ordinary(table: ArmTable, wrist: str, seed: int) -> Ordinary:
    """Draw an arm with ordinary errors.

    Parameters
    ----------
    wrist
        "elastic": all joints give way; "rigid": those of the table's wrist do not.
    """
    streams = partial(stream, seed, "mujoco", "ordinary")
    tolerances = {
        name: _within(streams("tolerance", name), span) for name, span in TOLERANCES.items()
    }
    bodies = [
        _erring(body, tolerances, partial(streams, row.link))
        for row, body in zip(table.links, table.inertials(), strict=True)
    ]
    machine = read_machine(urdf_text(table, bodies))
    _put_points(table, machine, streams)
    elastic = tuple(
        row.joint for row in table.links if wrist == "elastic" or row.joint not in table.wrist
    )
    stiffness, damping = _put_drives(table, machine, elastic, streams)
    loose = _put_compliance(table, machine, elastic, streams)
    offset = np.deg2rad(tolerances["encoder_offset_deg"])
    return Ordinary(
        table=table,
        machine=machine,
        bench=_bench(table, tolerances, streams),
        elastic=elastic,
        offsets_rad={
            row.joint: offset * _unit(streams("encoder", row.joint)) for row in table.links
        },
        tolerances=tolerances,
        stiffness=stiffness,
        damping=damping,
        loose=loose,
    )


def _within(rng: np.random.Generator, span: tuple[float, float]) -> float:
    low, high = span
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _unit(rng: np.random.Generator) -> float:
    """One standard deviation, and no more than two and a half of them."""
    return float(np.clip(rng.standard_normal(), -2.5, 2.5))


def _erring(body: Inertial, tolerances: dict[str, float], streams: Streams) -> Inertial:
    mass = body.mass_kg * (1.0 + tolerances["mass"] * _unit(streams("mass")))
    rng = streams("center")
    center = np.array(body.center_m) + tolerances["center_m"] * np.array(
        [_unit(rng) for _ in range(3)]
    )
    # Scaling the body along its principal axes keeps the inertia one that a body can have.
    moments, axes = np.linalg.eigh(body.matrix())
    second = np.maximum(0.5 * np.sum(moments) - moments, 0.0)
    rng = streams("inertia")
    second *= 1.0 + tolerances["inertia"] * np.array([_unit(rng) for _ in range(3)])
    inertia = axes @ np.diag(np.sum(second) - second) @ axes.T
    return Inertial.of(mass, center, inertia * (mass / body.mass_kg))


def _put_points(table: ArmTable, machine: Machine, streams: Streams) -> None:
    spread = _within(streams("point spread"), POINT_ERROR_M)
    for point in shell_points(table):
        error = spread * streams("point", point.id).standard_normal(3)
        machine.places[point.id] = Place(
            body=point.link, at_m=point.position_m + error, R_body_sensor=point.R_link_sensor
        )


def _put_drives(
    table: ArmTable, machine: Machine, elastic: tuple[str, ...], streams: Streams
) -> tuple[dict[str, Believed], dict[str, Believed]]:
    """Springs of the drives, and what the data sheet lets one believe of them."""
    stiffness, damping = {}, {}
    for row in table.links:
        if row.joint not in elastic:
            continue
        body, sheet = machine.moved_by(row.joint), row.stiffness_n_m_per_rad
        true = sheet * np.exp(DRIVE_SCATTER * _unit(streams("stiffness", row.joint)))
        carried = _inertia_about(table, row.joint)
        ratio = _within(streams("damping", row.joint), DAMPING_RATIO)
        loss = 2.0 * ratio * np.sqrt(true * carried)
        middle = 2.0 * np.sqrt(DAMPING_RATIO[0] * DAMPING_RATIO[1] * sheet * carried)
        body.axes.append(_axis(row.joint, body.drive_axis, float(true), float(loss)))
        stiffness[row.joint] = Believed(
            value=sheet, std=DRIVE_DOUBT * sheet, source="data sheet of a gear of this size"
        )
        damping[row.joint] = Believed(
            value=middle, std=0.7 * middle, source="guess: one to two percent of critical"
        )
    return stiffness, damping


def _axis(name: str, direction: Array, stiffness: float, damping: float) -> Axis:
    return Axis(
        name=name,
        direction=np.array(direction),
        at_m=np.zeros(3),
        stiffness=stiffness,
        damping=damping,
    )


def _inertia_about(table: ArmTable, joint: str) -> float:
    """Inertia that a joint carries in the first posture, kg m^2; of the table."""
    T, axis, at, total = np.eye(4), np.zeros(3), np.zeros(3), 0.0
    reached = False
    plain = read_machine(urdf_text(table))
    for row, degrees in zip(table.links, table.postures_deg[0], strict=True):
        body = plain.moved_by(row.joint)
        turn, angle = np.eye(4), np.deg2rad(degrees)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        T = T @ body.T_parent_body @ turn
        if row.joint == joint:
            axis, at, reached = T[:3, 2], T[:3, 3], True
        if reached and body.inertial is not None:
            lever = np.cross(axis, T[:3, :3] @ np.array(body.inertial.center_m) + T[:3, 3] - at)
            own = T[:3, :3].T @ axis
            total += float(own @ body.inertial.matrix() @ own)
            total += body.inertial.mass_kg * float(lever @ lever)
    return total


def _put_compliance(
    table: ArmTable, machine: Machine, elastic: tuple[str, ...], streams: Streams
) -> dict[str, float]:
    """Bearings of the first three joints, the base's rocking, and two long links.

    Returns half of the most that each can have, as its standard deviation.
    """
    drives = {name: machine.axis(name).stiffness for name in elastic}
    rows = {row.joint: row for row in table.links}
    loose: dict[str, float] = {}

    def give(
        body: Body, name: str, at_m: Array, normal: Array, drive: str, span: tuple[float, float]
    ) -> None:
        stiffness = drives[drive] / _within(streams("compliance", name), span)
        loss = stiffness * _within(streams("loss", name), LOSS_TIME_S)
        for i, direction in enumerate(np.linalg.svd(normal[None, :])[2][1:]):
            axis = _axis(f"{name} {i + 1}", direction, stiffness, loss)
            axis.at_m = at_m
            body.axes.append(axis)
            loose[axis.name] = 0.5 * span[1] / drives[drive]

    for joint in elastic[:3]:
        body = machine.moved_by(joint)
        name = f"bearing {joint}"
        give(body, name, np.zeros(3), body.drive_axis, joint, BEARING_COMPLIANCE)
    up = np.array([0.0, 0.0, 1.0])
    give(machine.bodies["base"], "base", np.zeros(3), up, elastic[0], BASE_COMPLIANCE)
    for joint in elastic[1:3]:
        outer, at, tangent = outer_half(machine, rows[joint])
        give(outer, f"bend {rows[joint].link}", at, tangent, joint, LINK_COMPLIANCE)
    return loose


def _bench(table: ArmTable, tolerances: dict[str, float], streams: Streams) -> Bench:
    rng = streams("sensor gain")
    gains = [tolerances["sensor_gain"] * _unit(rng) for _ in range(3)]
    return Bench(
        sensor=np.diag(1.0 + np.array(gains)),
        tilt_rad=float(np.deg2rad(tolerances["sensor_tilt_deg"])),
        aim_rad=float(np.deg2rad(tolerances["hit_direction_deg"])),
        blow_m=_within(streams("blow"), BLOW_SPREAD_M),
        noise_m_s2=_within(streams("noise"), NOISE_M_S2),
        noise_n=_within(streams("force noise"), NOISE_OF_PEAK) * table.peaks_n[0],
        highpass_hz=round(_within(streams("highpass"), HIGHPASS_HZ), 2),
        pulse_s=_within(streams("pulse"), PULSE_S),
        hammer_gain=1.0 + tolerances["hammer_gain"] * _unit(streams("hammer gain")),
    )
