"""Slow disturbances of the force record: undershoot of AC coupling, drift, hum of the mains."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["without_disturbance", "without_undershoot"]

Signal = npt.NDArray[np.float64]

_MAINS_HZ = (50.0, 60.0)
_HARMONICS = (1, 3)
_FEWEST_PERIODS = 3.0  # of the mains beside the pulse: fewer cannot be told from a push
_FEWEST_SAMPLES = 128
_MOST_SAMPLES = 2048
_ROUNDS = 3
_FAR = 4.0  # standard deviations
_MAD = 1.4826  # standard deviation over median absolute deviation, normal noise


def without_undershoot(force_n: Signal, rate_hz: float, highpass_hz: float) -> Signal:
    """Undo first-order AC coupling of a force about zero between pulses.

    y = s/(s + wc) x gives x = y + wc times the integral of y, here by the rectangle rule.
    """
    undone: Signal = force_n + 2.0 * np.pi * highpass_hz / rate_hz * np.cumsum(force_n)
    return undone


def without_disturbance(force_n: Signal, rate_hz: float, quiet: npt.NDArray[np.bool_]) -> Signal:
    """Force less the straight line and the mains hum that fit its quiet samples best.

    Least squares over the samples marked `quiet` (at most 2048, evenly spread), with a line, the
    mains frequency and its third harmonic; 50 or 60 Hz, whichever leaves less. Three rounds, each
    without the samples more than four standard deviations off, so that a second pulse among them
    does not bend the fit. With less than three quiet periods the record comes back as it is.

    Parameters
    ----------
    force_n : (n,)
        Force record.
    rate_hz
        Sampling rate.
    quiet : (n,)
        Samples away from the pulse.
    """
    at = np.flatnonzero(quiet)
    if len(at) < max(_FEWEST_PERIODS * rate_hz / _MAINS_HZ[0], _FEWEST_SAMPLES):
        return force_n
    at = at[:: -(-len(at) // _MOST_SAMPLES)]
    t = np.arange(len(force_n)) / rate_hz
    fits = [_fit(_columns(t, f, rate_hz), force_n, at) for f in _MAINS_HZ]
    disturbance = min(fits, key=lambda fit: fit[0])[1]
    return force_n - disturbance


def _fit(columns: Signal, force_n: Signal, at: npt.NDArray[np.intp]) -> tuple[float, Signal]:
    """Scatter about the fit, and the fit at every sample."""
    design, value = columns[at], force_n[at]
    kept = np.ones(len(at), dtype=np.bool_)
    fit: Signal = np.zeros(columns.shape[1])
    scatter = 0.0
    for _ in range(_ROUNDS):
        fit = np.asarray(np.linalg.lstsq(design[kept], value[kept], rcond=1e-9)[0], np.float64)
        off = np.abs(value - design @ fit)
        scatter = _MAD * float(np.median(off))
        kept = off <= _FAR * scatter
        if 2 * np.count_nonzero(kept) < _FEWEST_SAMPLES:
            break
    return scatter, columns @ fit


def _columns(t: Signal, mains_hz: float, rate_hz: float) -> Signal:
    rows = [np.ones_like(t), t / t[-1] - 0.5]
    for tone in (mains_hz * k for k in _HARMONICS if mains_hz * k < 0.4 * rate_hz):
        rows += [np.cos(2.0 * np.pi * tone * t), np.sin(2.0 * np.pi * tone * t)]
    return np.array(rows).T
