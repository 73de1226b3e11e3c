"""What every arm of beams and every test of it has wrong, nulls included.

Each cause draws from its own stream, evenly between bounds of this maker's own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable, Array, Inertial
from armodal.hil_sim.makers.belief import Believed
from armodal.hil_sim.makers.frame.beams import Section, flattened, tube
from armodal.hil_sim.makers.frame.drive_loss import LOSS_AT_HZ, DriveLoss
from armodal.hil_sim.makers.frame.parts import Drive, Parts
from armodal.hil_sim.makers.shell_points import shell_points
from armodal.hil_sim.streams import stream

__all__ = ["Everyday", "Gear", "everyday", "redrawn", "within"]

Streams = Callable[..., np.random.Generator]
Span = tuple[float, float]

TOLERANCES: dict[str, Span] = {
    "mass": (0.015, 0.06),
    "inertia": (0.025, 0.1),
    "center_m": (0.001, 0.005),
    "encoder_offset_deg": (0.03, 0.15),
    "sensor_tilt_deg": (0.5, 1.8),
    "sensor_gain": (0.003, 0.0095),
    "hammer_gain": (0.004, 0.012),
    "hit_direction_deg": (0.8, 2.6),
}
SPREAD = np.sqrt(3.0)  # an even draw of one standard deviation reaches so far
DRIVE_OFF = 0.4  # of ln of the true stiffness from the table's, at most
SHEET_OFF = 0.15  # of ln of the believed one
DOUBT: Span = (0.3, 0.5)  # relative std of the believed stiffness
DRIVE_LOSS: Span = (0.02, 0.08)  # of the dashpot, loss factor at `LOSS_AT_HZ`
STIFFER: Span = (0.0, 0.11)  # a drive that moves fast than one at rest
SLOW_LN_HZ: Span = (np.log(1.6), np.log(60.0))  # where it begins to be
FAST_LN: Span = (np.log(1.4), np.log(15.0))  # over that, where it is
TILT: Span = (0.001, 0.016)  # compliance of a bearing over its drive's
TILT_ASKEW: Span = (0.65, 1.5)  # of one tilt's stiffness over the other's
LEVER_M: Span = (0.04, 0.12)  # root of tilt over shift stiffness, of a bearing
BEARING_LOSS: Span = (0.003, 0.11)  # loss factor
LOCKED: Span = (150.0, 500.0)  # stiffness of a rigid wrist's joint over its drive's
PLATE: Span = (0.0003, 0.006)  # rocking compliance of the base's footing over the first drive's
PLATE_LEVER: Span = (0.4, 1.2)  # root of rocking over shift stiffness, over the base's diameter
PLATE_LOSS: Span = (0.004, 0.12)
MODULUS: Span = (0.85, 1.1)  # of the shells, over the table's
BEND: Span = (0.00025, 0.007)  # compliance of a whole link, below; ribs see to it
BASE_BEND: Span = (0.0003, 0.0032)  # of the base's casting over the first drive's
HIGH: Span = (-0.8, 0.8)  # ln of how high a shell is over how wide: 100 mm by 45 to 220
SHELL_LOSS: Span = (0.001, 0.04)
POINT_OFF_M: Span = (0.001, 0.0028)
BLOW_OFF_M: Span = (0.001, 0.0035)
NOISE_M_S2: Span = (0.001, 0.006)
HUM_M_S2: Span = (0.0, 0.003)
FORCE_NOISE: Span = (5e-5, 5e-4)  # of a soft hit's peak
CORNER_HZ: Span = (0.1, 0.5)
CONTACT_S: Span = (0.0024, 0.0055)


@dataclass(slots=True, kw_only=True)
class Gear:
    """Sensors, hammer and hand; faults of the measurement edit it."""

    response: Array  # (3, 3) what is told of what is felt
    tilt_rad: float
    aim_rad: float
    off_m: float
    noise_m_s2: float
    hum_m_s2: float
    noise_n: float
    corner_hz: float
    contact_s: float
    force_gain: float
    lag_s: float = 0.0
    added_kg: float = 0.0
    exchanged: dict[str, str] = field(default_factory=dict)  # where a point's sensor truly is


@dataclass(frozen=True, slots=True, kw_only=True)
class Everyday:
    """An arm of beams with what is believed of it."""

    table: ArmTable
    parts: Parts
    gear: Gear
    elastic: tuple[str, ...]
    tolerances: dict[str, float]
    stiffness: dict[str, Believed]
    damping: dict[str, Believed]
    loss: dict[str, DriveLoss]


def within(rng: np.random.Generator, span: Span) -> float:
    """Draw evenly."""
    return float(rng.uniform(*span))


def everyday(table: ArmTable, wrist: str, seed: int) -> Everyday:
    """Draw an arm of beams as arms are."""
    streams = partial(stream, seed, "frame", "everyday")
    tolerances = {
        name: within(streams("tolerance", name), span) for name, span in TOLERANCES.items()
    }
    elastic = tuple(
        row.joint for row in table.links if wrist == "elastic" or row.joint not in table.wrist
    )
    drives, loss = _drives(table, elastic, streams)
    sections = _sections(table, drives, elastic, streams)
    rock = drives[elastic[0]].stiffness / within(streams("plate"), PLATE)
    lever = table.base_shell.diameter_m * within(streams("plate lever"), PLATE_LEVER)
    offset = np.deg2rad(tolerances["encoder_offset_deg"])
    off = within(streams("points"), POINT_OFF_M)
    parts = Parts(
        table=table,
        bodies=[
            _erring(body, tolerances, partial(streams, row.link))
            for row, body in zip(table.links, table.inertials(), strict=True)
        ],
        sections=sections,
        beam_loss=within(streams("shell loss"), SHELL_LOSS),
        drives=drives,
        plate=np.diag([rock / lever**2] * 3 + [rock, rock, 2.0 * rock]),
        plate_loss=within(streams("plate loss"), PLATE_LOSS),
        offsets_rad={
            row.joint: offset * _even(streams("encoder", row.joint)) for row in table.links
        },
        position_m={
            point.id: point.position_m
            + off * np.array([_even(streams("point", point.id, i)) for i in range(3)])
            for point in shell_points(table)
        },
    )
    stiffness, damping = _believed(table, elastic, streams)
    return Everyday(
        table=table,
        parts=parts,
        gear=_gear(table, tolerances, streams),
        elastic=elastic,
        tolerances=tolerances,
        stiffness=stiffness,
        damping=damping,
        loss=loss,
    )


def redrawn(drawn: Everyday, streams: Streams) -> Parts:
    """Return the arm with other errors of its bodies and encoders, within the tolerances."""
    parts, tolerances = drawn.parts.copy(), drawn.tolerances
    rows = drawn.table.links
    parts.bodies = [
        _erring(body, tolerances, partial(streams, row.link))
        for row, body in zip(rows, drawn.parts.bodies, strict=True)
    ]
    offset = np.deg2rad(tolerances["encoder_offset_deg"])
    for row in rows:
        parts.offsets_rad[row.joint] += offset * _even(streams("encoder", row.joint))
    return parts


def _even(rng: np.random.Generator) -> float:
    """One standard deviation, drawn evenly."""
    return float(rng.uniform(-SPREAD, SPREAD))


def _erring(body: Inertial, tolerances: dict[str, float], streams: Streams) -> Inertial:
    """A body with errors within its tolerances, stretched as a whole so that it stays one."""
    mass = body.mass_kg * (1.0 + tolerances["mass"] * _even(streams("mass")))
    shift = [tolerances["center_m"] * _even(streams("center", i)) for i in range(3)]
    whole = body.matrix()
    second = 0.5 * np.trace(whole) * np.eye(3) - whole
    stretch = np.diag(
        [np.sqrt(1.0 + tolerances["inertia"] * _even(streams("inertia", i))) for i in range(3)]
    )
    second = stretch @ second @ stretch * (mass / body.mass_kg)
    return Inertial.of(mass, np.array(body.center_m) + shift, np.trace(second) * np.eye(3) - second)


def _drives(
    table: ArmTable, elastic: tuple[str, ...], streams: Streams
) -> tuple[dict[str, Drive], dict[str, DriveLoss]]:
    drives, losses = {}, {}
    for row in table.links:
        own = partial(streams, row.joint)
        gives = row.joint in elastic
        off = np.exp(within(own("stiffness"), (-DRIVE_OFF, DRIVE_OFF)))
        drive = row.stiffness_n_m_per_rad * float(off)
        tilt = drive / within(own("tilt"), TILT)
        loss = _loss(own)
        stiffness = drive if gives else drive * within(own("locked"), LOCKED)
        drives[row.joint] = Drive(
            stiffness=stiffness,
            law=loss.law(stiffness),
            tilt=(tilt, tilt * within(own("askew"), TILT_ASKEW)),
            shift_n_per_m=tilt / within(own("lever"), LEVER_M) ** 2,
            tilt_loss=within(own("bearing loss"), BEARING_LOSS),
        )
        losses[row.joint] = loss
    return drives, losses


def _loss(streams: Streams) -> DriveLoss:
    slow = float(np.exp(within(streams("slow"), SLOW_LN_HZ)))
    return DriveLoss(
        factor=within(streams("loss"), DRIVE_LOSS),
        stiffer=within(streams("stiffer"), STIFFER),
        band_hz=(slow, slow * float(np.exp(within(streams("fast"), FAST_LN)))),
    )


def _sections(
    table: ArmTable, drives: dict[str, Drive], elastic: tuple[str, ...], streams: Streams
) -> dict[str, Section]:
    """Shells of the table's tubes, ribbed where a plain tube would bend more than drawn.

    That is a part of the drive's compliance, or of the softest of the first three where less.
    """
    shells = {"base": table.base_shell} | {row.link: row.shell for row in table.links}
    modulus = table.youngs_modulus_pa * within(streams("modulus"), MODULUS)
    # A drive of the wrist may be ten times softer: nobody builds a forearm by that.
    softest = max(1.0 / drives[joint].stiffness for joint in elastic[:3])
    gives = {row.link: softest for row in table.links} | {
        row.link: min(1.0 / drives[row.joint].stiffness, softest)
        for row in table.links
        if row.joint in elastic
    }
    gives["base"] = gives[table.links[0].link]
    sections = {}
    for name, shell in shells.items():
        plain = tube(shell.diameter_m, shell.wall_m, modulus, table.density_kg_m3)
        length = float(np.sum(np.linalg.norm(np.diff(np.array(shell.path), axis=0), axis=1)))
        bend = within(streams("bend", name), BASE_BEND if name == "base" else BEND) * gives[name]
        ribbed = length / (plain.mean_moment_m4 * bend)
        high = np.exp(within(streams("high", name), HIGH))
        x, y, z = streams("width", name).standard_normal(3).tolist()
        box = flattened(plain, float(high), (x, y, z))
        sections[name] = replace(box, youngs_pa=max(modulus, ribbed))
    return sections


def _believed(
    table: ArmTable, elastic: tuple[str, ...], streams: Streams
) -> tuple[dict[str, Believed], dict[str, Believed]]:
    stiffness, damping = {}, {}
    for row in table.links:
        if row.joint not in elastic:
            continue
        own = partial(streams, "believed", row.joint)
        value = row.stiffness_n_m_per_rad
        value *= float(np.exp(within(own("value"), (-SHEET_OFF, SHEET_OFF))))
        doubt = within(own("doubt"), DOUBT)
        loss = float(np.mean(DRIVE_LOSS)) * value / (2.0 * np.pi * LOSS_AT_HZ)
        stiffness[row.joint] = Believed(value=value, std=doubt * value, source="maker's data sheet")
        damping[row.joint] = Believed(value=loss, std=0.8 * loss, source="of arms alike")
    return stiffness, damping


def _gear(table: ArmTable, tolerances: dict[str, float], streams: Streams) -> Gear:
    gains = [tolerances["sensor_gain"] * _even(streams("gain", i)) for i in range(3)]
    return Gear(
        response=np.diag(1.0 + np.array(gains)),
        tilt_rad=float(np.deg2rad(tolerances["sensor_tilt_deg"])),
        aim_rad=float(np.deg2rad(tolerances["hit_direction_deg"])),
        off_m=within(streams("blow"), BLOW_OFF_M),
        noise_m_s2=within(streams("noise"), NOISE_M_S2),
        hum_m_s2=within(streams("hum"), HUM_M_S2),
        noise_n=within(streams("force noise"), FORCE_NOISE) * table.peaks_n[0],
        corner_hz=round(within(streams("corner"), CORNER_HZ), 2),
        contact_s=within(streams("contact"), CONTACT_S),
        force_gain=1.0 + tolerances["hammer_gain"] * _even(streams("hammer gain")),
    )
