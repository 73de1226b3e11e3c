"""What moved a resonance from mounting to mounting, and how it is said.

A sensor of mass m at a point lowers a mode by m |phi|^2 / (2 M) of its frequency, M the modal mass
for the shape phi (Rayleigh): its shifts fall with the square of the shape at the mounting. A
structure that warms up, or settles, shifts with the order in which it was measured. Each is a
straight line through the mountings' frequencies; that which explains more of their scatter is
told, if it explains most of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.modes import ModalModel, Mode
from armodal.analyzer.modal.random_effects import Quantity

__all__ = ["DriftTold", "drift_told"]

MOST = 0.5  # of the variance between mountings: what explains less is not the cause


@dataclass(frozen=True, slots=True, kw_only=True)
class DriftTold:
    """One mode's drift in numbers and words."""

    f_hz: float
    lowest: tuple[str, float]  # mounting, Hz
    highest: tuple[str, float]
    half_power_bandwidths: float  # between them
    cause: str  # "sensor mass", "order of measurement", or "" where neither explains most of it
    explained: float  # share of the variance between mountings
    f_without_sensor_hz: float | None  # where the sensor's mass is the cause
    words: str


def drift_told(model: ModalModel) -> tuple[DriftTold, ...]:
    """Tell of every mode that moves, by frequency."""
    return tuple(
        _told(model, mode, mode.drift.f_hz) for mode in model.modes if mode.drift is not None
    )


def _told(model: ModalModel, mode: Mode, drift: Quantity) -> DriftTold:
    low, high = int(np.argmin(drift.drawn)), int(np.argmax(drift.drawn))
    bandwidth = 2.0 * mode.damping_ratio * mode.f_hz
    order = np.arange(drift.value.size, dtype=np.float64)
    candidates = [("order of measurement", *_line(order, drift.value, drift.value_std))]
    size = _shape_size(model, mode)
    if size is not None:
        slope, at_zero, explained = _line(size, drift.value, drift.value_std)
        if slope < 0.0:
            candidates.append(("sensor mass", slope, at_zero, explained))
    cause, _, at_zero, explained = max(candidates, key=lambda found: found[3])
    if explained < MOST:
        cause = ""
    without = at_zero if cause == "sensor mass" else None
    names = model.mountings
    words = (
        f"{mode.f_hz:.5g} Hz moves from {drift.drawn[low]:.6g} Hz (point {names[low]}) to "
        f"{drift.drawn[high]:.6g} Hz (point {names[high]}), "
        f"{(drift.drawn[high] - drift.drawn[low]) / bandwidth:.2g} half-power bandwidths: "
    )
    if cause == "sensor mass":
        words += f"as the sensor's mass does; {at_zero:.6g} Hz without it"
    elif cause:
        words += "with the order of measurement, as temperature or settling does"
    else:
        words += "neither as the sensor's mass nor with the order; look at mounting and fixing"
    return DriftTold(
        f_hz=mode.f_hz,
        lowest=(names[low], float(drift.drawn[low])),
        highest=(names[high], float(drift.drawn[high])),
        half_power_bandwidths=float((drift.drawn[high] - drift.drawn[low]) / bandwidth),
        cause=cause,
        explained=explained,
        f_without_sensor_hz=without,
        words=words,
    )


def _shape_size(model: ModalModel, mode: Mode) -> npt.NDArray[np.float64] | None:
    """Squared shape at each mounting of the sensor; None where the hammer roved."""
    if model.mounting.shape[1] > 1 and len(set(model.mounting[0])) > 1:
        return None
    squares = np.abs(mode.shape) ** 2
    size = np.bincount(model.mounting[:, 0], weights=squares, minlength=len(model.mountings))
    return np.asarray(size, dtype=np.float64)


def _line(
    x: npt.NDArray[np.float64], y: npt.NDArray[np.float64], std: npt.NDArray[np.float64]
) -> tuple[float, float, float]:
    """Slope, value at 0, and explained share of the variance of a weighted straight line."""
    w = np.where(np.isfinite(std), 1.0 / np.maximum(std, np.median(std)) ** 2, 0.0)
    w = w / w.sum()
    mx, my = float(w @ x), float(w @ y)
    sxx, sxy, syy = w @ (x - mx) ** 2, w @ ((x - mx) * (y - my)), w @ (y - my) ** 2
    if sxx <= 0.0 or syy <= 0.0:
        return 0.0, my, 0.0
    slope = float(sxy / sxx)
    return slope, my - slope * mx, float(sxy**2 / (sxx * syy))
