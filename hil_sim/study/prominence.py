"""How far an effect stands out: the held-out error without it against what the true model leaves.

A case is *clear* when the best model without the effect leaves at least three times the error on
the postures for validation that the true model leaves there. Here the best model is the erring
plant itself, refitted in all that a careful analyst would leave uncertain, each with its prior:
springs, dampers, masses, weak bearings, encoders, gains, tilts, directions, a delay. Errors are in
units of an allowance, 1.2 % of each line, 0.7 % of each channel and noise; the floor is one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant import BASE, Plant
from armodal.hil_sim.small_motion import Mounting, force_torque, linearise, sensor_rows
from armodal.hil_sim.study.arms import StudyArm
from armodal.hil_sim.study.model_error import Tables, plant_of_tables
from armodal.hil_sim.study.nuisances import WIDEST, Nuisance, nuisances
from armodal.protocols.plan_records import PlannedPosture

__all__ = ["Bystander"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

BAND_HZ = (6.0, 100.0)
EVERY = 4  # lines of the record's resolution that are looked at
DECAY_RAD_S = 2.0 * np.pi * 2.5  # real part of the Laplace lines: as wide as modes are apart
LINE, CHANNEL = 0.012, 0.007  # allowance
FLOOR_MOTION = 0.05  # allowance on the base, as part of the arm's middle channel
TILT, DIRECTION = 0.016, 0.022  # rad
PART = 0.1  # of a deviation, the step of differences
ITERATIONS = 8
GAIN, SKEW_S = 0.011, 50e-6
CROSS = np.full((3, 3), 0.004) + 0.007 * np.eye(3)  # gains of the channels and their cross talk
N_SENSING = 11  # hammer, three gains with cross talk, delay


@dataclass(frozen=True, slots=True)
class _Posture:
    wanted: ComplexArray
    allowance: Array
    columns: Array  # (2 n, n_global) without their local part
    local: Array  # (2 n, n_local)
    gain: Array  # (n_local, 2 n)

    def without_local(self, y: Array) -> Array:
        """What the posture's own nuisances leave of a column or of columns."""
        result: Array = y - self.local @ (self.gain @ y)
        return result


class Bystander:
    """The erring arm of one case without any effect, and its sensitivities."""

    def __init__(self, study: StudyArm, tables: Tables) -> None:
        plan = study.plan
        everywhere = tuple(point.id for point in study.arm.points)
        postures = tuple(replace(posture, points=everywhere) for posture in plan.postures)
        self._study = replace(study, plan=replace(plan, postures=postures))
        self._tables = tables
        self._plant = plant_of_tables(tables)
        self.s, self._noise = _lines_and_noise(study, self._plant)

    def stands_out(self, tables: Tables) -> float:
        """Held-out error against the floor for a plant with a linear effect, without measuring.

        Flips, gains and delays of the sensors count; what is not linear does not.
        """
        plant = plant_of_tables(tables)
        frfs = self._model(plant)
        sensing = plant.sensing
        for j, point in enumerate(self._study.plan.postures[0].points):
            gains = sensing.gains(point)
            mixed = np.einsum("ij,pjl->pil", gains[1:, 1:], frfs[:, j]) / gains[0, 0]
            late = np.array(sensing.delay_s[1:])[:, None] - sensing.delay_s[0]
            frfs[:, j] = mixed * np.exp(-self.s * late)
        # Noise and allowance are there without any effect: they are the floor.
        return float(np.hypot(1.0, self.held_out(frfs)))

    def held_out(self, frfs: ComplexArray) -> float:
        """Rms error on the validation postures in allowances, refitted on the others.

        Springs and dampers are free; no other nuisance goes beyond three deviations. Gauss-Newton
        with the sensitivities of the beginning: the model itself is evaluated at each step.
        """
        fitted = [not posture.validation for posture in self._study.plan.postures]
        J = np.concatenate([r.columns for r, used in zip(self._ready, fitted, strict=True) if used])
        normal = J.T @ J
        x = np.zeros(J.shape[1])
        errors = self._errors(frfs, x)
        cost = _cost(errors, fitted, x)
        part = 1.0
        for _ in range(ITERATIONS):
            y = np.concatenate([e for e, used in zip(errors, fitted, strict=True) if used])
            aim = _bounded_step(normal, J.T @ y + normal @ x, self._bounds)
            there = x + part * (aim - x)
            errors_there = self._errors(frfs, there)
            cost_there = _cost(errors_there, fitted, there)
            if cost_there >= cost:
                part *= 0.3
                continue
            gained, x, errors, cost = cost - cost_there, there, errors_there, cost_there
            if gained < 1e-3 * cost:
                break
        kept = np.concatenate([e for e, used in zip(errors, fitted, strict=True) if not used])
        return float(np.sqrt(np.mean(kept**2)))

    def _errors(self, frfs: ComplexArray, x: Array) -> list[Array]:
        """What is left of each posture's FRFs for nuisances x in deviations."""
        tables = self._tables
        for nuisance, value in zip(self._nuisances, x, strict=False):
            tables = nuisance.apply(tables, float(value))
        model = self._model(plant_of_tables(tables))
        sensing = x[len(self._nuisances) :]
        mixing = np.eye(3) + CROSS * sensing[1:10].reshape(3, 3)
        model = np.einsum("ij,qpjl->qpil", mixing, model)
        model *= (1.0 + GAIN * sensing[0]) * np.exp(-SKEW_S * sensing[10] * self.s)
        return [
            ready.without_local(_stacked(((one - other) / ready.allowance)[None])[0])
            for one, other, ready in zip(frfs, model, self._ready, strict=True)
        ]

    @cached_property
    def _ready(self) -> list[_Posture]:
        """Expectations, allowances and sensitivities of each posture."""
        wanted = self._model(self._plant)
        columns = self._columns(wanted)
        sensor, hammer = self._plant.truth.accelerometer, self._plant.truth.hammer
        # Any floor passes something on: base motion of a few per cent of the arm's tells nothing.
        points = [self._plant.point(name) for name in self._study.plan.postures[0].points]
        moving = np.array([point.body != BASE for point in points])
        result = []
        for i in range(len(wanted)):
            size = np.abs(wanted[i])
            rms = np.sqrt(np.mean(size**2, axis=-1, keepdims=True))
            rms[~moving] = FLOOR_MOTION / CHANNEL * np.median(rms[moving])
            noisy = self._noise**2 * (sensor.noise_m_s2**2 + (hammer.noise_n * size) ** 2)
            allowance = np.sqrt((LINE * size) ** 2 + (CHANNEL * rms) ** 2 + noisy)
            local = _stacked(self._local(wanted[i], i) / allowance).T
            # What belongs to the posture alone is refitted in either kind of posture.
            gain = np.asarray(np.linalg.solve(local.T @ local + np.eye(local.shape[1]), local.T))
            ready = _Posture(wanted[i], allowance, np.zeros((0, 0)), local, gain)
            block = ready.without_local(_stacked(columns[:, i] / allowance).T)
            result.append(_Posture(wanted[i], allowance, block, local, gain))
        return result

    @cached_property
    def _nuisances(self) -> list[Nuisance]:
        return nuisances(self._tables)

    @cached_property
    def _bounds(self) -> Array:
        """Largest value of each global nuisance, in deviations."""
        return np.array([*(n.bound for n in self._nuisances), *(WIDEST,) * N_SENSING])

    def _model(self, plant: Plant) -> ComplexArray:
        """FRFs (n_postures, n_points, 3, n_lines) of a plant with straight sensors."""
        return np.stack(
            [
                _posture_frfs(plant, self._study, posture, self.s)
                for posture in self._study.plan.postures
            ]
        )

    def _columns(self, before: ComplexArray) -> ComplexArray:
        """Change of the FRFs by one deviation of each global nuisance."""
        columns = [
            (self._model(plant_of_tables(one.apply(self._tables, PART))) - before) / PART
            for one in self._nuisances
        ]
        columns.append(GAIN * before)
        for i in range(3):
            for j in range(3):
                row = np.zeros_like(before)
                row[:, :, i] = before[:, :, j]
                columns.append(CROSS[i, j] * row)
        columns.append(-SKEW_S * self.s * before)
        return np.stack(columns)

    def _local(self, frfs: ComplexArray, number: int) -> ComplexArray:
        """Change of one posture's FRFs by the direction of its hits and each sensor's tilt."""
        posture = self._study.plan.postures[number]
        columns = []
        across = np.linalg.svd(np.array([posture.hit_direction], dtype=np.float64))[2][1:]
        for direction in across:
            turned = _posture_frfs(self._plant, self._study, posture, self.s, direction)
            columns.append(DIRECTION * turned)
        for point in range(len(frfs)):
            for axis in range(3):
                i, j = (axis + 1) % 3, (axis + 2) % 3
                tilted = np.zeros_like(frfs)
                tilted[point, i], tilted[point, j] = frfs[point, j], -frfs[point, i]
                columns.append(TILT * tilted)
        return np.stack(columns)


def _stacked(columns: ComplexArray) -> Array:
    """Real and imaginary parts of each column in a row."""
    flat = columns.reshape(len(columns), -1)
    return np.hstack([flat.real, flat.imag])


def _posture_frfs(
    plant: Plant,
    study: StudyArm,
    posture: PlannedPosture,
    s: ComplexArray,
    direction: Array | None = None,
) -> ComplexArray:
    """FRFs (n_points, 3, n_lines) with the high passes of hammer and sensor."""
    motion = linearise(plant, posture.joints_rad, None)
    hit = plant.point(study.plan.fixed_point)
    wanted = posture.hit_direction if direction is None else direction
    if wanted is None:
        raise ValueError(f"posture {posture.name!r} has no hit_direction")
    torque = force_torque(plant, motion.at, hit.body, hit.position_m, wanted)
    n = len(motion.mass)
    into = motion.inverse_modes[:, n : 2 * n] @ np.linalg.solve(motion.mass, torque)
    swing = motion.modes @ (into[:, None] / (s - motion.poles[:, None]))
    pushed = np.linalg.solve(motion.mass, torque)
    rates = motion.state_matrix[n : 2 * n] @ swing + pushed[:, None]
    rows = []
    for point in posture.points:
        mounting = Mounting(point_id=point, R_link_sensor=plant.point(point).R_link_sensor)
        acceleration, tilt = sensor_rows(plant, motion.at, mounting)
        rows.append(acceleration @ rates + tilt @ swing[:n])
    truth = plant.truth
    passed = 1.0 + 2.0 * np.pi * truth.hammer.highpass_hz / s
    passed /= 1.0 + 2.0 * np.pi * truth.accelerometer.highpass_hz / s
    return np.array(rows) * passed


def _cost(errors: list[Array], fitted: list[bool], x: Array) -> float:
    return float(x @ x + sum(e @ e for e, used in zip(errors, fitted, strict=True) if used))


def _bounded_step(normal: Array, right: Array, bounds: Array) -> Array:
    """Ridge solution of the normal equations; what goes beyond its bound is held there."""
    matrix = normal + np.eye(len(normal))
    step = np.zeros(len(normal))
    free = np.ones(len(normal), dtype=bool)
    while np.any(free):
        rest = right[free] - matrix[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.solve(matrix[np.ix_(free, free)], rest)
        beyond = free & (np.abs(step) > bounds)
        if not np.any(beyond):
            break
        step[beyond] = np.sign(step[beyond]) * bounds[beyond]
        free &= ~beyond
    return step


def _lines_and_noise(study: StudyArm, plant: Plant) -> tuple[ComplexArray, Array]:
    """Laplace lines, and (n_lines,) what unit noise a sample makes of H1 after middle hits."""
    sampling, hand = study.plan.sampling, plant.truth.hand
    rate_hz = float(sampling.rate_hz)
    s = _lines(sampling.samples, rate_hz)
    t = np.arange(sampling.samples) / rate_hz
    width = float(np.mean(hand.width_s))
    phase = (t - sampling.pretrigger / rate_hz) / width
    inside = (phase > 0.0) & (phase < 1.0)
    pulse = np.where(inside, np.sin(np.pi * phase), 0.0) * np.sqrt(np.prod(study.peak_n))
    force = np.abs(np.exp(-np.outer(s, t)) @ pulse)
    noise = np.sqrt(np.sum(np.exp(-2.0 * s[0].real * t)) / study.plan.hits_per_point) / force
    return s, noise


def _lines(n: int, rate_hz: float) -> ComplexArray:
    """Laplace variable in rad/s of the lines looked at, a part of those of the record's FFT."""
    f_hz = np.fft.rfftfreq(n, 1.0 / rate_hz)
    lines = np.flatnonzero((f_hz > BAND_HZ[0]) & (f_hz < BAND_HZ[1]))[::EVERY]
    s: ComplexArray = DECAY_RAD_S + 2j * np.pi * f_hz[lines].astype(np.complex128)
    return s
