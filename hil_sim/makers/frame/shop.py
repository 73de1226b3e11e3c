"""The frame maker's laboratory: hits in the Laplace plane, records out of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, Inertial, rotation
from armodal.hil_sim.makers.frame.everyday import Everyday, Gear
from armodal.hil_sim.makers.frame.frfs import felt_per_wrench, wrench
from armodal.hil_sim.makers.frame.modal import modal
from armodal.hil_sim.makers.frame.parts import Parts
from armodal.hil_sim.makers.frame.standing import stand
from armodal.hil_sim.makers.frame.structure import Complex
from armodal.hil_sim.makers.session_records import Recorded, Recorder, session_of
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import KnownMass, Mode, Plan, PlannedPosture
from armodal.protocols.session.records import Session

__all__ = ["Shop"]

Streams = Callable[..., np.random.Generator]

WRAP = 1e-6  # what is left of what would come round again, after twice the record
PASS, STOP = 0.4, 0.47  # of the rate: ends of the recorder's low pass
GRID_S = 5e-5  # of the pulse's integral
ANGLE_NOISE_RAD = 1.5e-5
LEVEL_OFF = 0.2  # of ln of a hit's peak from the one wanted, at most
CONTACT_OFF = 0.1  # of ln of its duration


@dataclass(frozen=True, slots=True, kw_only=True)
class Shop:
    """Arm as believed, parts as they are."""

    seed: int
    arm: Arm
    drawn: Everyday
    parts: Parts
    gear: Gear

    def measure(
        self,
        plan: Plan,
        levels_n: Sequence[float] | None,
        known: KnownMass | None,
        run: int,
        *,
        brakes: bool,
    ) -> Session:
        """Measure a plan."""
        streams = partial(stream, self.seed, "frame", "shop", run)
        hits: list[Recorded] = []
        for posture in plan.postures:
            parts = self.parts.copy()
            mass = posture.known_mass or known
            if mass is not None:
                parts.added.append((mass.link, _bar(mass)))
            parts.braked = brakes or posture.brakes
            hits += self._posture(parts, plan, posture, levels_n, partial(streams, posture.name))
        recorder = Recorder(
            name="frame maker",
            full_scale=(5.0 * self.drawn.table.peaks_n[-1], 300.0),
            bits=24,
            highpass_hz=self.gear.corner_hz,
        )
        return session_of(self.arm, plan, recorder, hits, "2026-04-01T10:00:00+00:00")

    def _posture(
        self,
        parts: Parts,
        plan: Plan,
        posture: PlannedPosture,
        levels_n: Sequence[float] | None,
        streams: Streams,
    ) -> list[Recorded]:
        gear = self.gear
        standing = stand(parts, posture.joints_rad)
        modes = modal(standing)
        rate, n = float(plan.sampling.rate_hz), plan.sampling.samples
        sigma = -np.log(WRAP) * rate / (2 * n)
        s = sigma + 2j * np.pi * np.fft.rfftfreq(2 * n, 1.0 / rate)
        roving = plan.mode is Mode.ROVING_RESPONSE
        points = list(posture.points)
        at = [standing.point(gear.exchanged.get(name, name)) for name in points]
        fixed = standing.point(gear.exchanged.get(plan.fixed_point, plan.fixed_point))
        sensors, struck = (at, [fixed]) if roving else ([fixed], at)
        felt = felt_per_wrench(
            standing,
            modes,
            s,
            [spot for spot, _ in sensors],
            [spot for spot, _ in struck],
            plan.sensor.mass_kg + gear.added_kg,
        )
        recorded = []
        for i, name in enumerate(points):
            sensor, hit = (i, 0) if roving else (0, i)
            R_sensor, R_hit = sensors[sensor][1], struck[hit][1]
            told = posture.hit_direction
            told = -R_hit[:, 2] if told is None else told
            mounted = R_sensor @ _leant(gear.tilt_rad, streams("mounted", plan.mode, sensor))
            for k, level in enumerate(self._levels(plan, posture, levels_n)):
                of_hit = partial(streams, name, k)
                aimed = _leant(gear.aim_rad, of_hit("aim")) @ told
                off = gear.off_m * of_hit("off").standard_normal(3)
                load = wrench(aimed, off - aimed * (off @ aimed))
                start = (plan.sampling.pretrigger - of_hit("start").uniform(0.0, 1.0)) / rate
                force = _pulse(gear, self.drawn.table.peaks_n[1], level, of_hit, s, start)
                response = (felt[sensor][:, :, hit, :] @ load) @ mounted * force[:, None]
                response = response @ gear.response.T
                response *= np.exp(-s * gear.lag_s)[:, None]
                spectra = np.column_stack([force * gear.force_gain, response])
                recorded.append(
                    Recorded(
                        posture=posture,
                        sensor_point=name if roving else plan.fixed_point,
                        hit_point=plan.fixed_point if roving else name,
                        direction=told,
                        readings=self._record(spectra, s, sigma, rate, n, of_hit),
                        joints_rad=posture.joints_rad
                        + ANGLE_NOISE_RAD
                        * of_hit("angles").standard_normal(len(posture.joints_rad)),
                    )
                )
        return recorded

    def _levels(
        self, plan: Plan, posture: PlannedPosture, levels_n: Sequence[float] | None
    ) -> list[float]:
        if levels_n is not None:
            return list(levels_n)
        levels = posture.peaks_n or self.drawn.table.peaks_n
        return [levels[i % len(levels)] for i in range(plan.hits_per_point)]

    def _record(
        self, spectra: Complex, s: Complex, sigma: float, rate: float, n: int, streams: Streams
    ) -> Array:
        """Time histories, (n, 4), through the recorder's filters, with noise."""
        gear, hz = self.gear, s.imag / (2.0 * np.pi)
        ramp = np.clip((hz / rate - PASS) / (STOP - PASS), 0.0, 1.0)
        through = 0.5 * (1.0 + np.cos(np.pi * ramp)) * s / (s + 2.0 * np.pi * gear.corner_hz)
        t = np.arange(n) / rate
        # The low pass rings before the blow too: that comes round to the half that is cut off.
        record = np.fft.irfft(spectra * through[:, None], 2 * n, axis=0)[:n] * rate
        record *= np.exp(sigma * t)[:, None]
        record[:, 0] += gear.noise_n * streams("force noise").standard_normal(n)
        record[:, 1:] += gear.noise_m_s2 * streams("noise").standard_normal((n, 3))
        phase = streams("hum").uniform(0.0, 2.0 * np.pi, 3)
        record[:, 1:] += gear.hum_m_s2 * np.sin(2.0 * np.pi * 50.0 * t[:, None] + phase)
        return np.asarray(record)


def _leant(spread_rad: float, rng: np.random.Generator) -> Array:
    """A small rotation, (3, 3), of that spread about every axis."""
    roll, pitch, yaw = spread_rad * rng.standard_normal(3)
    return rotation((float(roll), float(pitch), float(yaw)))


def _bar(mass: KnownMass) -> Inertial:
    """A round steel bar as long as it is thick, about its centre."""
    radius = (mass.mass_kg / (7850.0 * 2.0 * np.pi)) ** (1.0 / 3.0)
    own = mass.mass_kg * radius**2 * np.diag([7.0 / 12.0, 7.0 / 12.0, 0.5])
    return Inertial.of(mass.mass_kg, mass.center_m, own)


def _pulse(
    gear: Gear, middle_n: float, level_n: float, streams: Streams, s: Complex, start_s: float
) -> Complex:
    """Laplace transform of a blow: a raised cosine that rises sooner than it falls, in N s.

    Harder blows are shorter by the power 1/5 of speed (Johnson, Contact Mechanics, eq. 11.24); the
    force goes with speed to the 6/5.
    """
    peak = level_n * float(np.exp(streams("level").uniform(-LEVEL_OFF, LEVEL_OFF)))
    length = gear.contact_s * (peak / middle_n) ** (-1.0 / 6.0)
    length *= float(np.exp(streams("contact").uniform(-CONTACT_OFF, CONTACT_OFF)))
    t = np.arange(0.0, length + GRID_S, GRID_S)
    phase = np.clip(t / length, 0.0, 1.0) ** float(streams("skew").uniform(0.82, 0.98))
    force = 0.5 * peak * (1.0 - np.cos(2.0 * np.pi * phase))
    spectrum: Complex = np.exp(-np.outer(s, t)) @ force * GRID_S * np.exp(-s * start_s)
    return spectrum
