"""A logged trajectory in a user's MJCF: what accelerometers read, before and after corrections.

The driven joints follow the logged angles, and the springs behind them give way as they may. Angles
and readings pass the same zero-phase filters, so that both are compared in one band: from a part of
the lowest mode, below which the arm moves as a rigid one and gravity turns in the sensor, to above
the highest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.corrected.prediction import modes_of_arm
from armodal.analyzer.export.exported import BELOW_HZ
from armodal.analyzer.simulator.comparison import simulated_arm
from armodal.analyzer.simulator.encoder_noise import read_by_noise
from armodal.analyzer.simulator.in_time import HELD, SimulatedArm, standing_model
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError, EstimateError
from armodal.protocols.foreign.motion_log import MotionLog

__all__ = ["FOLLOWS", "PointComparison", "compare_with_motion"]

Array = npt.NDArray[np.float64]

FOLLOWS = "the drives follow the commands"
_BELOW, _ABOVE = 1 / 3, 1.5  # of the lowest and the highest mode
_OF_RATE = 0.4  # the band ends below half the rate
_ORDER = 4
_NOISY = 0.5  # of what a sensor reads, that the angles' noise alone may make it read
_SETTLED = 2.0  # periods of the band's low end that filters and start take, at both ends


@dataclass(frozen=True, slots=True, kw_only=True)
class PointComparison:
    """An accelerometer on a trajectory: measured, and in the simulator with each of two arms."""

    point: str
    error_before: float  # rms of the difference over the rms of the measured, three axes
    error_after: float
    moved: float  # rms of the corrected arm's reading over the measured's
    band_hz: tuple[float, float]
    axis: int  # of the sensor, on which the plain arm is furthest off
    time_s: Array  # (n,)
    measured_m_s2: Array  # (n,) along that axis, in the band
    before_m_s2: Array
    after_m_s2: Array


def compare_with_motion(
    log: MotionLog,
    plain: Arm,
    corrected: Arm,
    source: Path,
    mujoco: Any,
    tell: Callable[[str], None],
) -> tuple[PointComparison, ...]:
    """Move the user's MJCF along a log, with the plain and the corrected arm.

    Raises
    ------
    ArmError, EstimateError
        If the file is not of this arm, the log is too short, too slow or too noisy, or the
        simulation fails.
    """
    _check_arms(log, plain, corrected)
    band_hz = _band(log, corrected)
    n = int(np.ceil(_SETTLED * log.rate_hz / band_hz[0]))
    if len(log.angles_rad) < 4 * n:
        raise EstimateError(
            f"wanted a log of at least {4 * n / log.rate_hz:.2g} s, of which the first and the "
            f"last {n / log.rate_hz:.2g} s settle, got {len(log.angles_rad) / log.rate_hz:.2g} s"
        )
    log = _quiet(log, corrected, band_hz, tell)
    inner = slice(n, -n)
    found = {}
    for when, arm in (("plain", plain), ("corrected", corrected)):
        tell(f"the log with the {when} arm, in time")
        found[when] = _readings(log, simulated_arm(arm, source, mujoco), band_hz[1])
    rows = []
    for point, measured in log.acceleration_m_s2.items():
        # Simulated readings are of angles that passed the low pass already.
        smooth = _smooth(measured, log.rate_hz, band_hz[1])
        own = _filtered(smooth, log.rate_hz, band_hz)[inner]
        size = float(np.linalg.norm(own))
        if size == 0.0:
            raise EstimateError(f"the accelerometer at point {point} reads nothing in the log")
        before, after = (
            _filtered(found[w][point], log.rate_hz, band_hz)[inner] for w in ("plain", "corrected")
        )
        axis = int(np.argmax(np.linalg.norm(before - own, axis=0)))
        rows.append(
            PointComparison(
                point=point,
                error_before=float(np.linalg.norm(before - own)) / size,
                error_after=float(np.linalg.norm(after - own)) / size,
                moved=float(np.linalg.norm(after)) / size,
                band_hz=band_hz,
                axis=axis,
                time_s=np.arange(n, n + len(own)) / log.rate_hz,
                measured_m_s2=own[:, axis],
                before_m_s2=before[:, axis],
                after_m_s2=after[:, axis],
            )
        )
    return tuple(rows)


def _check_arms(log: MotionLog, plain: Arm, corrected: Arm) -> None:
    """One log serves both: their joints and the points with sensors are the same."""
    joints, others = ([joint.name for joint in arm.joints] for arm in (plain, corrected))
    lacking = sorted(set(log.acceleration_m_s2) - {point.id for point in plain.points})
    if joints != others or lacking:
        raise ArmError(
            f"wanted the joints {', '.join(others)} and the points "
            f"{', '.join(log.acceleration_m_s2)} of arm '{corrected.name}' in the session's arm "
            f"'{plain.name}' too, got the joints {', '.join(joints)}"
            f"{', without points ' + ', '.join(lacking) if lacking else ''}; give the arm file "
            "that came from this session"
        )


def _band(log: MotionLog, arm: Arm) -> tuple[float, float]:
    angles = log.angles_rad
    some = np.rad2deg(angles[:: max(1, len(angles) // 8)]).tolist()
    modes = [own.f_hz for own in modes_of_arm(arm, some, below_hz=BELOW_HZ)]
    low, high = _BELOW * min(f[0] for f in modes), _ABOVE * max(f[-1] for f in modes)
    if _OF_RATE * log.slowest_hz < 1.0 / _BELOW * low:
        raise EstimateError(
            f"wanted a log with at least {low / _BELOW / _OF_RATE:.0f} rows a second, above the "
            f"arm's lowest mode, got {log.slowest_hz:.0f}"
        )
    return float(low), float(min(high, _OF_RATE * log.slowest_hz))


def _quiet(
    log: MotionLog, arm: Arm, band_hz: tuple[float, float], tell: Callable[[str], None]
) -> MotionLog:
    """The log, its drives following commands where the encoders' noise would drown the motion."""
    for point, measured in log.acceleration_m_s2.items():
        own = _filtered(measured, log.rate_hz, band_hz)
        reads = float(np.sqrt((own**2).sum(axis=1).mean()))
        noise = read_by_noise(arm, log.angles_rad, log.rate_hz, band_hz, point)
        if noise <= _NOISY * reads:
            continue
        said = (
            f"the angles' noise alone makes the accelerometer at point {point} read {noise:.2g} "
            f"m/s² in the band, where it reads {reads:.2g}"
        )
        if log.encoder_rad is None or log.command_rad is None:
            raise EstimateError(
                f"wanted angles that move the arm more than they are noisy, got {said}; log a "
                "faster move, finer angles, or the commands"
            )
        tell(f"{FOLLOWS}: {said}")
        return _quiet(replace(log, encoder_rad=None), arm, band_hz, tell)
    return log


def _filtered(values: Array, rate_hz: float, band_hz: tuple[float, float]) -> Array:
    sos = scipy.signal.butter(_ORDER, band_hz, "bandpass", fs=rate_hz, output="sos")
    return np.asarray(scipy.signal.sosfiltfilt(sos, values, axis=0))


def _smooth(values: Array, rate_hz: float, top_hz: float) -> Array:
    sos = scipy.signal.butter(_ORDER, top_hz, "lowpass", fs=rate_hz, output="sos")
    return np.asarray(scipy.signal.sosfiltfilt(sos, values, axis=0))


def _readings(log: MotionLog, own: SimulatedArm, top_hz: float) -> dict[str, Array]:
    """(n, 3) of every accelerometer."""
    mujoco: Any = own.mujoco
    angles = _smooth(log.angles_rad, log.rate_hz, top_hz)
    time = np.arange(len(angles)) / log.rate_hz
    curve = scipy.interpolate.make_interp_spline(time, angles, k=5)
    sensors = list(log.acceleration_m_s2)
    model, data, n_steps = standing_model(own, sensors, curve(0.0), log.rate_hz)
    at = [int(model.joint(joint.name).dofadr[0]) for joint in own.arm.joints]
    data.qvel[at] = curve(0.0, 1)
    state = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros(mujoco.mj_stateSize(model, state))
    mujoco.mj_getState(model, data, start, state)
    middle = (np.arange((len(time) - 1) * n_steps + 1) + 0.5) / (n_steps * log.rate_hz)
    control = np.zeros((1, len(middle), model.nv))
    control[0][:, at] = HELD * curve(np.minimum(middle, time[-1]), 2)
    rollout: Any = import_module("mujoco.rollout")
    _, readings = rollout.rollout(
        [model],
        [mujoco.MjData(model)],
        start[None],
        control,
        control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED),
    )
    if not np.isfinite(readings).all():
        raise EstimateError(
            "the simulation of the log did not stay finite; look at the model in MuJoCo's own "
            "viewer"
        )
    first = int(model.nsensordata) - 3 * len(sensors)
    seen = readings[0, ::n_steps, first:]
    return {name: seen[:, 3 * i : 3 * i + 3] for i, name in enumerate(sensors)}
