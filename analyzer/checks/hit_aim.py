"""What the aim of the hits does to the FRFs of a point, told by the hits themselves.

Each point of a roving sensor is measured with hits of its own, each a little off in place and
direction. With real modes an error of aim scales every mode's part of the response by a real
factor, the same on all three axes of the point. So a point's mean may be off

- by its own hits' differences (their directions in the space of errors, however modes overlap),
- by a real gain that is continuous and piecewise linear in log frequency, with knots at the peaks
  of the summed response; how large, the hits of all points together say.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import signal

__all__ = ["aim_patterns"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_PROMINENCE_DB = 3.0
_SINGLE_HIT_GAIN = 0.03  # where no point has two hits
_LEAST_GAIN = 0.005
_MOST_OWN = 4  # of a point's own differences, the largest


def aim_patterns(
    freq_hz: Array, values: ComplexArray, hits: Sequence[ComplexArray]
) -> ComplexArray:
    """Likely errors of the mean by the aim of the hits, each of one standard deviation.

    Parameters
    ----------
    values
        (n, 3, n_lines) mean FRFs per point.
    hits
        Per point (n_hits, 3, n_lines) FRFs of its single hits.

    Returns
    -------
    (n, n_patterns, 3, n_lines) complex128
        Zero where a point has fewer patterns than others.
    """
    hats = _hats(freq_hz, values)
    spread = _gain_spread(hats, values, hits)
    counts = np.array([max(len(own), 1) for own in hits])
    scale = spread / np.sqrt(counts)[:, None]
    smooth = scale[:, :, None, None] * hats[None, :, None, :] * values[:, None]
    own = np.zeros((len(values), _MOST_OWN, *values.shape[1:]), dtype=np.complex128)
    for p, frfs in enumerate(hits):
        n = len(frfs)
        if n < 2:
            continue
        # The mean of n has the covariance of single hits over n; these span the same.
        d = (frfs - frfs.mean(axis=0)).reshape(n, -1) / np.sqrt(n * (n - 1))
        _, sizes, right = np.linalg.svd(d, full_matrices=False)
        kept = min(n - 1, _MOST_OWN)
        own[p, :kept] = (sizes[:kept, None] * right[:kept]).reshape(kept, *values.shape[1:])
    return np.concatenate([smooth, own], axis=1)


def _hats(freq_hz: Array, values: ComplexArray) -> Array:
    """Piecewise linear functions of log frequency, one a peak, that sum to one."""
    total = 10.0 * np.log10(np.maximum(np.sum(np.abs(values) ** 2, axis=(0, 1)), 1e-300))
    peaks, _ = signal.find_peaks(total, prominence=_PROMINENCE_DB)
    if len(peaks) < 2:
        return np.ones((1, len(freq_hz)))
    knots = np.log(freq_hz[peaks])
    return np.stack([np.interp(np.log(freq_hz), knots, row) for row in np.eye(len(knots))])


def _gain_spread(hats: Array, values: ComplexArray, hits: Sequence[ComplexArray]) -> Array:
    """Standard deviation (n_hats,) of single hits' real gains near each knot, over all points."""
    total = np.zeros(len(hats))
    freedom = 0
    for mean, frfs in zip(values, hits, strict=True):
        n = len(frfs)
        if n < 2:
            continue
        power = (np.abs(mean) ** 2).sum(axis=0) @ hats.T
        gain = (frfs * mean.conj()).real.sum(axis=1) @ hats.T / np.maximum(power, 1e-300)
        total += ((gain - gain.mean(axis=0)) ** 2).sum(axis=0)
        freedom += n - 1
    if freedom == 0:
        return np.full(len(hats), _SINGLE_HIT_GAIN)
    return np.maximum(np.sqrt(total / freedom), _LEAST_GAIN)
