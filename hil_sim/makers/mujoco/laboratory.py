"""A case's laboratory: what it measures of its machine, plan by plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import mujoco
import numpy as np
import scipy

from armodal.hil_sim.makers.arm_table import Array, Inertial
from armodal.hil_sim.makers.mujoco.compiled import Compiled, compiled, jacobian
from armodal.hil_sim.makers.mujoco.hammer import Blow, blow, force_n
from armodal.hil_sim.makers.mujoco.in_time import ring_in_time
from armodal.hil_sim.makers.mujoco.machine import Body, Machine, turned
from armodal.hil_sim.makers.mujoco.ordinary import Bench, Ordinary
from armodal.hil_sim.makers.mujoco.small_signal import ring_linear, small_signal
from armodal.hil_sim.makers.session_records import Recorded, Recorder, session_of
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import KnownMass, Mode, Plan, PlannedPosture
from armodal.protocols.session.records import Session

__all__ = ["PRETRIGGER", "RATE_HZ", "SAMPLES", "Laboratory", "site_jacobian", "true_angles"]

Streams = Callable[..., np.random.Generator]

RATE_HZ, SAMPLES, PRETRIGGER = 1250, 1750, 40  # of a record; samples, those before the trigger
FINER = 2  # steps in a sample, on the modes' recursion
FINER_IN_TIME = 8  # steps of a simulation in time
FILTER_HALF = 15  # samples; linear phase, its delay taken off, as recorders do
ENCODER_NOISE_RAD = 2e-5
BRAKES_HOLD = 500.0  # times as stiff as the servo


@dataclass(frozen=True, slots=True, kw_only=True)
class Laboratory:
    """Arm as believed, machine as it is."""

    seed: int
    arm: Arm
    ordinary: Ordinary
    machine: Machine
    bench: Bench

    def measure(
        self,
        plan: Plan,
        levels_n: Sequence[float] | None = None,
        known: KnownMass | None = None,
        run: int = 0,
        *,
        brakes: bool = False,
    ) -> Session:
        """Measure a plan: every point of every posture, one hit a level."""
        hits: list[Recorded] = []
        streams = partial(stream, self.seed, "mujoco", "measurement", run)
        for posture in plan.postures:
            machine = self.machine.copy()
            mass = posture.known_mass or known
            if mass is not None:
                _bolt_on(machine, mass, "known mass")
            if brakes or posture.brakes:
                for servo in machine.servos:
                    servo.stiffness *= BRAKES_HOLD
            hits += self._posture(machine, plan, posture, levels_n, partial(streams, posture.name))
        recorder = Recorder(
            name="mujoco maker",
            full_scale=(4.0 * self.ordinary.table.peaks_n[-1], 500.0),
            bits=24,
            highpass_hz=self.bench.highpass_hz,
        )
        return session_of(self.arm, plan, recorder, hits, "2026-03-01T09:00:00+00:00")

    def _posture(
        self,
        machine: Machine,
        plan: Plan,
        posture: PlannedPosture,
        levels_n: Sequence[float] | None,
        streams: Streams,
    ) -> list[Recorded]:
        finer = FINER_IN_TIME if machine.nonlinear else FINER
        rate = finer * float(plan.sampling.rate_hz)
        samples = finer * plan.sampling.samples
        angles = true_angles(self.ordinary, posture.joints_rad)
        peaks = self._peaks(plan, posture, levels_n)
        strikes: list[_Strike] = []
        plants: dict[str, Compiled] = {}
        for point in posture.points:
            sensor, struck = point, plan.fixed_point
            if plan.mode is Mode.ROVING_HAMMER:
                sensor, struck = struck, sensor
            if sensor not in plants:
                plants[sensor] = _with_sensor(
                    machine, self.bench, plan.sensor.mass_kg, sensor, angles, 1.0 / rate
                )
            for i, peak in enumerate(peaks):
                of_hit = partial(streams, point, i)
                aimed = self._aimed(machine, plants[sensor], posture, struck)
                swing = blow(self.bench, of_hit, peak, self.ordinary.table.peaks_n[1], aimed[0])
                load = _load(machine, plants[sensor], struck, swing)
                start = (plan.sampling.pretrigger + swing.late_samples) * finer / rate
                strikes.append(
                    _Strike(
                        sensor=sensor,
                        struck=struck,
                        told=aimed[1],
                        load=load,
                        force=force_n(swing, rate, samples, start),
                        streams=of_hit,
                    )
                )
        readings = _rung(plants, strikes, rate, linear=not machine.nonlinear)
        return [
            Recorded(
                posture=posture,
                sensor_point=strike.sensor,
                hit_point=strike.struck,
                direction=strike.told,
                readings=self._recorded(strike, reading, float(plan.sampling.rate_hz), streams),
                joints_rad=posture.joints_rad
                + ENCODER_NOISE_RAD
                * strike.streams("encoders").standard_normal(len(posture.joints_rad)),
            )
            for strike, reading in zip(strikes, readings, strict=True)
        ]

    def _peaks(
        self, plan: Plan, posture: PlannedPosture, levels_n: Sequence[float] | None
    ) -> list[float]:
        levels = list(levels_n or posture.peaks_n or self.ordinary.table.peaks_n)
        if levels_n is not None:
            return levels
        return [levels[i % len(levels)] for i in range(plan.hits_per_point)]

    def _aimed(
        self, machine: Machine, plant: Compiled, posture: PlannedPosture, struck: str
    ) -> tuple[Array, Array]:
        """Direction that the hand means, and the one that the session tells."""
        if posture.hit_direction is not None:
            told = posture.hit_direction
        else:
            place = machine.places[struck]
            R = jacobian(plant, place.body, place.at_m)[2]
            told = -R @ place.R_body_sensor[:, 2]
        turn = self.bench.turned_hits.get(posture.name, np.eye(3))
        return turn @ told, told

    def _recorded(self, strike: _Strike, reading: Array, rate_hz: float, streams: Streams) -> Array:
        """Mounting, gains, filters and noise; one column of force, three of response."""
        bench = self.bench
        axis = bench.tilt_rad * streams("mounting", strike.sensor).standard_normal(3)
        size = float(np.linalg.norm(axis))
        felt = (reading - reading[0]) @ turned(axis / max(size, 1e-12), size)[:3, :3]
        felt = felt @ bench.sensor.T @ bench.point_sensor.get(strike.sensor, np.eye(3)).T
        force = strike.force * bench.hammer_gain
        record = np.column_stack([force, felt])
        record = _decimated(record, FINER_IN_TIME if self.machine.nonlinear else FINER)
        if bench.late_s:
            record[:, 1:] = _later(record[:, 1:], bench.late_s * rate_hz)
        corner = 2.0 * np.pi * bench.highpass_hz / (2.0 * rate_hz)
        record = scipy.signal.lfilter(
            np.array([1.0, -1.0]) / (1.0 + corner),
            [1.0, -(1.0 - corner) / (1.0 + corner)],
            record,
            0,
        )
        n = len(record)
        record[:, 0] += bench.noise_n * strike.streams("force noise").standard_normal(n)
        record[:, 1:] += bench.noise_m_s2 * strike.streams("noise").standard_normal((n, 3))
        return np.asarray(record * bench.window_end ** (np.arange(n) / n)[:, None])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Strike:
    sensor: str
    struck: str
    told: Array
    load: Array
    force: Array
    streams: Streams


def true_angles(drawn: Ordinary, told_rad: Array) -> dict[str, float]:
    """True angle of each joint where the controller tells `told_rad`."""
    rows = drawn.table.links
    return {
        row.joint: float(told) + drawn.offsets_rad[row.joint]
        for row, told in zip(rows, told_rad, strict=True)
    }


def _bolt_on(machine: Machine, mass: KnownMass, name: str) -> None:
    side = (mass.mass_kg / 7850.0) ** (1.0 / 3.0)  # a cube of steel
    body = Inertial.of(mass.mass_kg, mass.center_m, mass.mass_kg * side**2 / 6.0 * np.eye(3))
    machine.bodies[name] = Body(name=name, parent=mass.link, T_parent_body=np.eye(4), inertial=body)


def _with_sensor(
    machine: Machine,
    bench: Bench,
    told_kg: float,
    point: str,
    angles: dict[str, float],
    step: float,
) -> Compiled:
    """The machine with one sensor, where it truly stands, and its mass."""
    place = machine.places[bench.stands_at.get(point, point)]
    mass = told_kg + bench.extra_kg
    loaded = replace(machine, bodies=dict(machine.bodies), places={point: place})
    if mass > 0.0:
        own = mass * 1e-4 * np.eye(3)  # a cube a few centimetres wide
        T = np.eye(4)
        loaded.bodies["sensor"] = Body(
            name="sensor",
            parent=place.body,
            T_parent_body=T,
            inertial=Inertial.of(mass, place.at_m, own),
        )
    return compiled(loaded, angles, step, slowed=machine.nonlinear)


def _load(machine: Machine, plant: Compiled, struck: str, swing: Blow) -> Array:
    place = machine.places[struck]
    linear, angular, _ = jacobian(plant, place.body, place.at_m)
    return np.asarray(
        linear.T @ swing.direction + angular.T @ np.cross(swing.off_m, swing.direction)
    )


def _rung(
    plants: dict[str, Compiled], strikes: Sequence[_Strike], rate_hz: float, *, linear: bool
) -> list[Array]:
    """What each strike's sensor feels, (samples, 3), gravity in it."""
    if not linear:
        return ring_in_time(
            [plants[strike.sensor] for strike in strikes],
            [strike.load for strike in strikes],
            [strike.force for strike in strikes],
        )
    systems = {name: small_signal(plant) for name, plant in plants.items()}
    rung = []
    for strike in strikes:
        plant = plants[strike.sensor]
        a, q = ring_linear(systems[strike.sensor], strike.load, strike.force, rate_hz)
        J, W, R = site_jacobian(plant)
        felt = a @ J.T + np.cross(q @ W.T, plant.model.opt.gravity)
        rung.append(felt @ R)
    return rung


def site_jacobian(plant: Compiled) -> tuple[Array, Array, Array]:
    """Jacobians, (3, nv) each, of the only sensor, and its rotation (3, 3)."""
    linear, angular = np.zeros((3, plant.model.nv)), np.zeros((3, plant.model.nv))
    site = int(plant.model.sensor_objid[0])
    mujoco.mj_jacSite(plant.model, plant.data, linear, angular, site)
    return linear, angular, plant.data.site_xmat[site].reshape(3, 3).copy()


def _decimated(record: Array, every: int) -> Array:
    half = FILTER_HALF * every
    taps = scipy.signal.firwin(2 * half + 1, 0.8 / every)
    padded = np.pad(record, ((half, half), (0, 0)), mode="edge")
    filtered = scipy.signal.oaconvolve(padded, taps[:, None], mode="valid", axes=0)
    return np.asarray(filtered[::every])


def _later(record: Array, samples: float) -> Array:
    """Delay a record by part of a sample, in frequency."""
    n = 2 * len(record)
    lines = np.fft.rfftfreq(n)
    spectrum = np.fft.rfft(record, n, axis=0) * np.exp(-2j * np.pi * lines * samples)[:, None]
    return np.asarray(np.fft.irfft(spectrum, n, axis=0)[: len(record)])
