"""Slow disturbances of the force record: drift, and hum of the mains."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["without_disturbance"]

Signal = npt.NDArray[np.float64]

_MAINS_HZ = (50.0, 60.0)
_HARMONICS = (1, 3)
_FEWEST_PERIODS = 2.5  # of the mains in the record: fewer cannot be told from a push
_FEWEST_SAMPLES = 128
_MOST_SAMPLES = 2048
_ROUNDS = 3
_FAR = 4.0  # standard deviations


def without_disturbance(force_n: Signal, rate_hz: float, quiet: npt.NDArray[np.bool_]) -> Signal:
    """Force less the straight line and the mains hum that fit its quiet samples best.

    Least squares over the samples marked `quiet` (at most 2048, evenly spread), three rounds, each
    without the samples more than four standard deviations off: a second pulse among them does not
    bend the fit. Records of less than two and a half periods, or too few quiet samples, come back
    as they are.

    Parameters
    ----------
    force_n : (n,)
        Force record.
    rate_hz
        Sampling rate.
    quiet : (n,)
        Samples away from the pulse.
    """
    n = len(force_n)
    at = np.flatnonzero(quiet)
    if n < _FEWEST_PERIODS * rate_hz / _MAINS_HZ[0] or len(at) < _FEWEST_SAMPLES:
        return force_n
    at = at[:: -(-len(at) // _MOST_SAMPLES)]
    tones = [f * k for f in _MAINS_HZ for k in _HARMONICS if f * k < 0.4 * rate_hz]
    columns = _columns(np.arange(n) / rate_hz, n / rate_hz, tones)
    design, value = columns[at], force_n[at]
    kept = np.ones(len(at), dtype=np.bool_)
    fit: Signal = np.zeros(columns.shape[1])
    for _ in range(_ROUNDS):
        fit = np.asarray(np.linalg.lstsq(design[kept], value[kept], rcond=1e-9)[0], np.float64)
        off = np.abs(value - design @ fit)
        kept = off <= _FAR * 1.4826 * float(np.median(off)) + np.finfo(float).tiny
        if np.count_nonzero(kept) < _FEWEST_SAMPLES // 2:
            break
    without: Signal = force_n - columns @ fit
    return without


def _columns(t: Signal, length_s: float, tones: list[float]) -> Signal:
    rows = [np.ones_like(t), t / length_s - 0.5]
    for tone in tones:
        rows += [np.cos(2.0 * np.pi * tone * t), np.sin(2.0 * np.pi * tone * t)]
    return np.array(rows).T
