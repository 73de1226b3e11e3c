"""The noise that a coherence tells, and how well it tells it.

With n averages and one set of forces, H1 leaves sum|X - H F|^2 = (1 - g) sum|X|^2 for a coherence
g as estimated, exactly and for any n from 2 on. Noise over force is then

    v = |H|^2 (1 - g) / (g (n - 1)),                                                  (1)

without bias. That an estimated coherence is too high, g = 1/n for noise alone, is the n - 1 in it.

What a file holds is y = 1 - g = s + e, with an error e beside: spectra were quantised, g was
rounded, or clipped at 1. Its standard deviation d is seen in the numbers themselves:

* the least step between two different values, over sqrt(12);
* as many lines as read 1 or more have an error towards more coherence that is larger than their
  noise share s; errors are as large the other way: the same number of lines, those next below 1.

Where s is well above d, (1) holds. Where it is not, the noise level N of the lines around decides:
the running median of v, each line with the weight of what it tells, 1 / (N^2 + (d |H|^2)^2 / (n -
1)). With an exponential prior of mean s0 = N (n - 1) / |H|^2 the share is expected at

    E s = m + d phi(m / d) / Phi(m / d),  m = y - d^2 / s0,                             (2)

the mean of a normal distribution cut off at 0: y where y is large, s0 where s0 is small.

References
----------
Carter, Knapp and Nuttall, IEEE Trans. Audio Electroacoust. 21 (1973) 337 (distribution of g).
Bendat and Piersol, Random Data, 4th ed. (2010), Eqs. (6.59), (9.73).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import scipy
from numpy.lib.stride_tricks import sliding_window_view

__all__ = ["CoherenceNoise", "coherence_noise"]

_Real = npt.NDArray[np.float64]

_LINES = 41  # of a running median: more than twice as many as the sharpest resonance takes
_NARROWER = 4  # each part than the one before
_PRIOR_LINES = 10.0  # that the level of the wider part weighs
_FAR = 1e3  # standard deviations, where two terms of 1 / z agree to a millionth
_ROUNDS = 4  # of weights from the level before
_LEAST_COHERENCE = 1e-6
_LEAST_LEVEL = 1e-10  # of |H|^2: five digits are as good as any analyser's calibration


@dataclass(frozen=True, slots=True, kw_only=True)
class CoherenceNoise:
    """Noise of one FRF."""

    scatter: _Real  # (n_freq,) of a single average, over its n - 1: Eq. (1) with Eq. (2)
    level: _Real  # (n_freq,) N, of the lines around
    resolution: float  # d
    unseen: float  # share of the lines whose noise is below d


def coherence_noise(
    magnitude_squared: _Real, coherence: _Real, n_averages: int
) -> CoherenceNoise | None:
    """Noise over force of one FRF; None where its coherence tells nothing.

    Parameters
    ----------
    magnitude_squared
        (n_freq,) |H|^2.
    coherence
        (n_freq,) as told: above 1 where the file has it so.
    n_averages
        Two or more; one average has a coherence of 1 whatever the noise.
    """
    if n_averages < 2:
        return None
    share = 1.0 - np.maximum(coherence, _LEAST_COHERENCE)
    resolution = _resolution(share)
    if resolution is None:
        return None
    several = float(n_averages - 1)
    size = np.maximum(magnitude_squared, np.finfo(float).tiny)
    level = _level(share, size, resolution, several)
    odds = level * several / size
    seen = _expected(share, odds / (1.0 + odds), resolution)
    return CoherenceNoise(
        scatter=size * seen / ((1.0 - seen) * several),
        level=level,
        resolution=resolution,
        unseen=float(np.mean(share < resolution)),
    )


def _resolution(share: _Real) -> float | None:
    """Standard deviation of the error of y; None where no line tells a noise."""
    above = np.sort(share[share > 0.0])
    if not above.size:
        return None
    steps = np.diff(np.unique(share))
    step = float(steps.min()) if steps.size else 0.0
    over = -share[share <= 0.0]
    mirrored = above[: over.size]
    error = max(_rms(over), _rms(mirrored))
    return float(np.hypot(step / np.sqrt(12.0), error))


def _rms(values: _Real) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0


def _level(share: _Real, size: _Real, resolution: float, several: float) -> _Real:
    """Noise level N of the lines around each: (n_freq,), above 0."""
    raw = size * share / ((1.0 - np.clip(share, 0.0, 1.0 - _LEAST_COHERENCE)) * several)
    error = (resolution * size) ** 2 / several
    # Sums of n - 1 squared magnitudes have their median below their mean.
    below = float(scipy.special.gammaincinv(several, 0.5)) / several
    least = _LEAST_LEVEL * size.mean()
    level = np.full(share.size, np.sqrt(error.min()) + least)
    for _ in range(_ROUNDS):
        weight = level**2 / (level**2 + error)
        level = np.maximum(_around(raw, weight) / below, least)
    return level


def _around(values: _Real, weight: _Real) -> _Real:
    """Weighted median of the lines around each, drawn towards that of ever wider parts."""
    n = values.size
    prior = np.full(n, _median(values[None], weight[None])[0])
    size = n // _NARROWER
    while size > _LINES:
        cuts = np.linspace(0, n, n // size + 1).astype(int)
        found = [
            _median(_with(values[a:b], prior[(a + b) // 2]), _with(weight[a:b], _PRIOR_LINES))[0]
            for a, b in pairwise(cuts)
        ]
        prior = np.interp(np.arange(n), 0.5 * (cuts[1:] + cuts[:-1]), found)
        size //= _NARROWER
    width = min(_LINES, n - 1 + n % 2)
    near, weights = (
        sliding_window_view(np.pad(x, width // 2, mode="reflect"), width) for x in (values, weight)
    )
    own = np.full((n, 1), _PRIOR_LINES)
    return _median(np.hstack([near, prior[:, None]]), np.hstack([weights, own]))


def _with(lines: _Real, prior: float) -> _Real:
    return np.append(lines, prior)[None]


def _median(values: _Real, weight: _Real) -> _Real:
    """Weighted median of each row: (n_rows,)."""
    order = np.argsort(values, axis=1)
    total = np.cumsum(np.take_along_axis(weight, order, axis=1), axis=1)
    at = np.argmax(total >= 0.5 * total[:, -1:], axis=1)
    rows = np.arange(len(values))
    result: _Real = values[rows, order[rows, at]]
    return result


def _expected(share: _Real, prior: _Real, resolution: float) -> _Real:
    """Eq. (2), the noise share of each line: above 0, below 1."""
    if resolution > 0.0:
        z = share / resolution - resolution / prior
        near = np.maximum(z, -_FAR)
        # phi / Phi in logarithms: both vanish far below 0. There z + phi / Phi goes to -1 / z.
        ratio = near + np.exp(-0.5 * (near**2 + np.log(2.0 * np.pi)) - scipy.special.log_ndtr(near))
        share = resolution * np.where(z > -_FAR, ratio, -1.0 / np.minimum(z, -_FAR))
    result: _Real = np.clip(share, 0.0, 1.0 - _LEAST_COHERENCE)
    return result
