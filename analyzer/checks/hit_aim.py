"""What the aim of the hits does to the FRFs of a point, told by the hits themselves.

Each point of a roving sensor is measured with hits of its own, each a little off in place and
direction. An error of aim changes how strongly a hit drives each mode, by a real factor that is
the same on all three axes of the point. So the mean of a point may be off by a gain on each mode's
part of its response; how large, the hits of all points together say, and the point's own
differences give the directions that overlapping or unfitted modes leave out.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from armodal.analyzer.checks.modal_basis import modal_basis, real_lines

__all__ = ["aim_patterns"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_SINGLE_HIT_GAIN = 0.05  # where no point has two hits
_LEAST_GAIN = 0.005
_TAIL = 4.0
_MOST_OWN = 3  # of a point's own differences, the largest


def aim_patterns(
    s: ComplexArray, poles: Sequence[complex], values: ComplexArray, hits: Sequence[ComplexArray]
) -> ComplexArray:
    """Likely errors of the mean by the aim of the hits, each of one standard deviation.

    Parameters
    ----------
    s
        (n_lines,) Laplace lines.
    poles
        Poles of the modes, one of each conjugate pair, in rad/s; may be empty.
    values
        (n, 3, n_lines) mean accelerance per point.
    hits
        Per point (n_hits, 3, n_lines) accelerance of its single hits.

    Returns
    -------
    (n, n_patterns, 3, n_lines) complex128
        Zero where a point has fewer patterns than others.
    """
    relative = 1.0 / np.sqrt(np.mean(np.abs(values) ** 2, axis=(0, 1)))
    basis = modal_basis(s, poles)
    fit: Array = np.linalg.pinv(real_lines(basis * relative)).astype(
        np.float64
    )  # (2 n_lines, n_basis)
    parts = _parts(basis, fit, values * relative)
    single = [_parts(basis, fit, own * relative) for own in hits]
    spread = _gain_spread(parts * relative, [part * relative for part in single])
    counts = np.array([max(len(own), 1) for own in hits])
    std = spread / np.sqrt(counts)[:, None]
    # To undo 1 + n takes 1 / (1 + n), whose tail is the heavier the larger n.
    std = std * (1.0 + _TAIL * std)
    modal = parts * std[:, :, None, None]
    return np.concatenate([modal, _own_differences(values, hits, relative)], axis=1)


def _parts(basis: ComplexArray, fit: Array, scaled: ComplexArray) -> ComplexArray:
    """Each mode's part (..., n_modes + 1, 3, n_lines) of responses (..., 3, n_lines)."""
    coefficients = real_lines(scaled) @ fit  # (..., 3, n_basis)
    modes = (len(basis) - 3) // 2
    edges = [*range(0, 2 * modes, 2), 2 * modes, len(basis)]
    return np.stack(
        [coefficients[..., a:b] @ basis[a:b] for a, b in pairwise(edges)],
        axis=-3,
    )


def _gain_spread(parts: ComplexArray, single: Sequence[ComplexArray]) -> Array:
    """Standard deviation (n_points, n_parts) of each part in single hits, relative to the mean.

    Summed over all points before it is divided: a part that is small at one point by chance of
    its hits has no say of its own.
    """
    total = np.zeros(parts.shape[1])
    power = np.zeros(parts.shape[1])
    for mean, own in zip(parts, single, strict=True):
        if len(own) < 2:
            continue
        total += (np.abs(own - own.mean(axis=0)) ** 2).sum(axis=(0, 2, 3)) / (len(own) - 1)
        power += (np.abs(mean) ** 2).sum(axis=(1, 2))
    if not power.any():
        return np.full(parts.shape[:2], _SINGLE_HIT_GAIN)
    spread = np.maximum(np.sqrt(total / np.maximum(power, np.finfo(float).tiny)), _LEAST_GAIN)
    return np.broadcast_to(spread, parts.shape[:2])


def _own_differences(
    values: ComplexArray, hits: Sequence[ComplexArray], relative: Array
) -> ComplexArray:
    """Differences between the hits of each point, (n, _MOST_OWN, 3, n_lines).

    A few hits tell the directions of the errors but hardly their sizes: with three, one of the two
    sizes is often far too small. Every direction is given the larger of the point's own largest
    size and the root mean square over all points, relative to the response.
    """
    norms = np.sqrt(np.sum(np.abs(values * relative) ** 2, axis=(1, 2)))
    own = np.zeros((len(values), _MOST_OWN, *values.shape[1:]), dtype=np.complex128)
    largest = np.zeros(len(values))
    several = np.array([len(frfs) > 1 for frfs in hits])
    for p, frfs in enumerate(hits):
        n = len(frfs)
        if n < 2:
            continue
        # The mean of n has the covariance of single hits over n; these span the same.
        d = ((frfs - frfs.mean(axis=0)) * relative).reshape(n, -1) / np.sqrt(n * (n - 1))
        _, sizes, right = np.linalg.svd(real_lines(d), full_matrices=False)
        kept = min(n - 1, _MOST_OWN)
        half = right.shape[1] // 2
        whole = right[:kept, :half] + 1j * right[:kept, half:]
        own[p, :kept] = whole.reshape(kept, 3, -1) / relative
        largest[p] = sizes[0] / norms[p]
    if np.any(several):
        typical = np.sqrt(np.mean(largest[several] ** 2))
        own *= (norms * np.maximum(largest, typical))[:, None, None, None]
    return own
