"""How far an effect stands out of what is ordinary: this maker's measure of size.

FRFs of the machine with and without the effect are compared, line by line, in parts of what
repeating a session changes: gains, noise, aim. What the tolerances, and stiffnesses and dampings
that nobody knows, can imitate is taken off by ridge regression, in which a cause costs by its
number of standard deviations (Tarantola, Inverse Problem Theory, section 3.2).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.makers.arm_table import Array, Inertial
from armodal.hil_sim.makers.mujoco.compiled import Compiled, compiled, jacobian
from armodal.hil_sim.makers.mujoco.in_time import ring_in_time
from armodal.hil_sim.makers.mujoco.laboratory import (
    RATE_HZ,
    SAMPLES,
    site_jacobian,
    true_angles,
)
from armodal.hil_sim.makers.mujoco.machine import Machine
from armodal.hil_sim.makers.mujoco.ordinary import Bench, Ordinary
from armodal.hil_sim.makers.mujoco.small_signal import small_signal

__all__ = ["Bystander"]

Complex = npt.NDArray[np.complex128]

POSTURES = (0, 2)
LINES_HZ = np.geomspace(4.0, 160.0, 72)
OF_ALL = 0.01  # of the root mean square of all FRFs: below it no model of an arm is right
BROAD = 0.06  # lines lie at s = (BROAD + j) omega: changes below that part of omega stay linear
LOCAL = 0.009  # of a line's magnitude, that repeating a session changes
OF_CHANNEL = 0.003  # of its FRF's root mean square
REPEATS = 3  # hits a point
PULSE_AREA = 0.556  # integral of sin^(3/2) over its half wave, over its length times its peak
ORDINARY_STD = 2.0  # that many standard deviations of a cause count like one part
FREE_STIFFNESS = 0.35  # std of ln k and ln c, that nobody knows
FREE_DAMPING = 0.7
SIMULATED_HZ = 2500.0
SIMULATED_S = 1.1
IN_TIME_HZ = 10000.0  # steps of hits that are simulated in time
EVERY = 5  # of the points, where hits are simulated in time


@dataclass(frozen=True)
class Bystander:
    """Somebody who sees FRFs of an arm with ordinary errors."""

    drawn: Ordinary
    joints_rad: tuple[Array, ...]  # told, of the plan's postures

    def stands_out(self, machine: Machine, bench: Bench) -> float:
        """Root of the mean square left plus the causes' cost; 1 is the least one could see."""
        timed = machine.nonlinear
        plain = self._plain_timed if timed else self._plain
        unit = self._unit[:, :: EVERY if timed else 1]
        causes = np.column_stack(
            [_flat(cause[:, :: EVERY if timed else 1] / unit) for cause in self._ordinary_causes]
        )
        changed = _flat((self._frfs(machine, bench, timed=timed) - plain) / unit)
        # Lines of one session hang together: their mean counts, not their number. A complex line
        # has two residuals of half a unit's variance.
        weight = np.sqrt(2.0 / len(changed))
        n = causes.shape[1]
        system = np.vstack([weight * causes, np.eye(n) / ORDINARY_STD])
        wanted = np.concatenate([weight * changed, np.zeros(n)])
        share, *_ = np.linalg.lstsq(system, wanted, rcond=None)
        return float(np.linalg.norm(wanted - system @ share))

    @cached_property
    def _plain(self) -> Complex:
        return self._frfs(self.drawn.machine, self.drawn.bench, timed=False)

    @cached_property
    def _plain_timed(self) -> Complex:
        return self._frfs(self.drawn.machine, self.drawn.bench, timed=True)

    @cached_property
    def _unit(self) -> Array:
        """What repeating the session changes, of every FRF and line."""
        drawn, bench = self.drawn, self.drawn.bench
        plain = self._plain
        rms = np.sqrt(np.mean(np.abs(plain) ** 2, axis=-1, keepdims=True))
        # White noise under a decaying weight, over the spectrum of a middle hit.
        force = PULSE_AREA * bench.pulse_s * drawn.table.peaks_n[1]
        noise = bench.noise_m_s2 / np.sqrt(2.0 * _lines(bench)[0].real * SIMULATED_HZ) / force
        square = (LOCAL * np.abs(plain)) ** 2 + (OF_CHANNEL * rms) ** 2 + noise**2 / REPEATS
        square += np.mean((OF_ALL * rms) ** 2)
        for turn in (np.roll(np.eye(3), 1, axis=0), np.roll(np.eye(3), 2, axis=0)):
            aside = self._frfs(drawn.machine, bench, timed=False, own_turn=turn)
            square += bench.aim_rad**2 / REPEATS * np.abs(aside) ** 2
        return np.asarray(np.sqrt(square))

    @cached_property
    def _ordinary_causes(self) -> list[Complex]:
        """Change of the FRFs by one standard deviation of each cause."""
        drawn, plain = self.drawn, self._plain
        tolerances = drawn.tolerances
        changes: list[Complex] = []
        for joint in drawn.elastic:
            for name, std in (("stiffness", FREE_STIFFNESS), ("damping", FREE_DAMPING)):
                machine = drawn.machine.copy()
                axis = machine.axis(joint)
                setattr(axis, name, getattr(axis, name) * (1.0 + 0.1 * std))
                changes.append(10.0 * (self._frfs(machine, drawn.bench, timed=False) - plain))
        for name, std in drawn.loose.items():
            machine = drawn.machine.copy()
            axis = machine.axis(name)
            axis.stiffness = 1.0 / (1.0 / axis.stiffness + 0.1 * std)
            changes.append(10.0 * (self._frfs(machine, drawn.bench, timed=False) - plain))
        for name, body in drawn.machine.bodies.items():
            if body.inertial is None or not body.parent:
                continue
            for changed in _bodies(body.inertial, tolerances):
                machine = drawn.machine.copy()
                machine.bodies[name].inertial = changed
                changes.append(self._frfs(machine, drawn.bench, timed=False) - plain)
        for row in drawn.table.links[1:]:
            offsets = dict(drawn.offsets_rad)
            offsets[row.joint] += np.deg2rad(tolerances["encoder_offset_deg"])
            changes.append(self._frfs(drawn.machine, drawn.bench, offsets, timed=False) - plain)
        changes.append(tolerances["hammer_gain"] * plain)
        for i in range(3):
            for j in range(3):
                size = tolerances["sensor_gain"] if i == j else drawn.bench.tilt_rad
                change = np.zeros_like(plain)
                change[:, :, i] = size * plain[:, :, j]
                changes.append(change)
        return changes

    def _frfs(
        self,
        machine: Machine,
        bench: Bench,
        offsets: dict[str, float] | None = None,
        *,
        timed: bool,
        own_turn: Array | None = None,
    ) -> Complex:
        """Accelerance, (postures, hit points, 3, lines), at the first point.

        `own_turn` turns each hit in its sensor's axes.
        """
        frfs = []
        for posture, told in enumerate(self.joints_rad):
            angles = true_angles(self.drawn, told)
            if offsets is not None:
                joints = (row.joint for row in self.drawn.table.links)
                angles = {j: a + offsets[j] for j, a in zip(joints, told, strict=True)}
            sensor = bench.stands_at.get("1", "1")
            whole = machine.copy()
            whole.places = {"1": machine.places[sensor]}
            plant = compiled(whole, angles, 1.0 / IN_TIME_HZ, slowed=timed)
            turn = bench.turned_hits.get(f"posture {POSTURES[posture] + 1}", np.eye(3))
            names = list(machine.places)[:: EVERY if timed else 1]
            loads = [_hit_load(machine, plant, name, turn, own_turn) for name in names]
            if timed:
                frfs.append(_timed(plant, loads, bench, self.drawn))
            else:
                frfs.append(_linear(plant, loads, bench))
        return np.array(frfs)


def _flat(values: Complex) -> Array:
    return np.concatenate([values.real.ravel(), values.imag.ravel()])


def _bodies(body: Inertial, tolerances: dict[str, float]) -> list[Inertial]:
    """The body with its mass, each coordinate of its centre, and its inertia off by one std."""
    center, inertia = np.array(body.center_m), body.matrix()
    grown = 1.0 + tolerances["mass"]
    changed = [Inertial.of(grown * body.mass_kg, center, grown * inertia)]
    for direction in np.eye(3):
        moved = center + tolerances["center_m"] * direction
        changed.append(Inertial.of(body.mass_kg, moved, inertia))
    changed.append(Inertial.of(body.mass_kg, center, (1.0 + tolerances["inertia"]) * inertia))
    return changed


def _hit_load(
    machine: Machine, plant: Compiled, point: str, turn: Array, own_turn: Array | None
) -> Array:
    place = machine.places[point]
    linear, _, R = jacobian(plant, place.body, place.at_m)
    own = np.eye(3) if own_turn is None else own_turn
    return np.asarray(linear.T @ (turn @ (-R @ place.R_body_sensor @ own[:, 2])))


def _lines(bench: Bench) -> tuple[Complex, Array]:
    """Lines, and the factor on the FRFs that delay and hammer bring, each (lines,)."""
    s = np.asarray((BROAD + 1j) * 2.0 * np.pi * LINES_HZ, dtype=np.complex128)
    return s, np.exp(-s * bench.late_s) / bench.hammer_gain


def _linear(plant: Compiled, loads: list[Array], bench: Bench) -> Complex:
    s, factor = _lines(bench)
    lines = s - np.log(bench.window_end) * RATE_HZ / SAMPLES
    J, W, R = site_jacobian(plant)
    system = small_signal(plant)
    if bench.extra_kg:
        system = system.with_mass(bench.extra_kg, J)
    moved = system.receptance(lines, np.array(loads).T)  # (lines, n, hits)
    g = plant.model.opt.gravity
    cross = np.array([[0.0, g[2], -g[1]], [-g[2], 0.0, g[0]], [g[1], -g[0], 0.0]])
    felt = np.einsum("ij,ljh->lih", J, moved) * (lines**2)[:, None, None]
    felt += np.einsum("ij,ljh->lih", cross @ W, moved)  # turned against gravity
    told = np.einsum("ij,ljh->lih", bench.sensor @ R.T, felt) * factor[:, None, None]
    return np.asarray(np.transpose(told, (2, 1, 0)))


def _timed(plant: Compiled, loads: list[Array], bench: Bench, drawn: Ordinary) -> Complex:
    s, factor = _lines(bench)
    t = np.arange(int(IN_TIME_HZ * SIMULATED_S)) / IN_TIME_HZ
    pulse = np.sin(np.pi * np.clip(t / bench.pulse_s, 0.0, 1.0)) ** 1.5 * drawn.table.peaks_n[1]
    rung = ring_in_time([plant] * len(loads), loads, [pulse] * len(loads))
    kernel = np.exp(-np.outer(s, t))
    felt = np.array([kernel @ (r - r[0]) for r in rung])  # (hits, lines, 3)
    told = felt @ bench.sensor.T * (factor / (kernel @ pulse))[:, None]
    return np.asarray(np.transpose(told, (0, 2, 1)))
