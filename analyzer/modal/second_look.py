"""Poles that a first fit missed, sought in what it left over.

One polynomial over a wide band resolves neither light damping nor crowded modes, and a strong
mode hides a weak one beside it. What the model leaves of the FRFs holds neither: where it stands
out of the noise, and is a visible part of the FRFs, a low-order fit of a few lines is enough.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from analyzer.modal.choice import candidate_poles
from analyzer.modal.noise import smooth_lines
from analyzer.modal.plscf import poles_plscf
from analyzer.modal.regression import ModalData, Regression, misfit

__all__ = ["left_over_poles"]

_LEAST_SHARE = 0.05  # of the FRFs' weighted amplitude that the misfit must be: a visible mode
_LEAST_RATIO = 1.5  # of the misfit over its median
_LEAST_Z = 8.0  # standard deviations of the noise's own scatter
_HALF_WIDTH = 1  # lines over which the misfit is averaged
_MARGIN = 14  # lines on either side of where it stands out
_MOST_ORDER = 10
_MOST_BANDS = 40  # a round


def _places(
    power: npt.NDArray[np.float64],
    size: npt.NDArray[np.float64],
    n_frf: int,
    line_share: float,
) -> list[tuple[int, int]]:
    """First and last line of each stretch where the misfit stands out, most conspicuous first."""
    lines = 2 * _HALF_WIDTH + 1
    level = smooth_lines(power, _HALF_WIDTH)
    usual = float(np.median(level))
    scatter = 1.0 / np.sqrt(n_frf * max(lines * line_share, 1.0))
    least = usual * max(_LEAST_RATIO, 1.0 + _LEAST_Z * scatter)
    out = (level > least) & (level > _LEAST_SHARE**2 * smooth_lines(size, _HALF_WIDTH))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(np.int8), [0]])))
    stretches = [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]
    stretches.sort(key=lambda ends: -float(level[ends[0] : ends[1] + 1].max()))
    return stretches[:_MOST_BANDS]


def left_over_poles(
    data: ModalData,
    fit: Regression,
    freq_hz: npt.NDArray[np.float64],
    n_ref: int,
    *,
    decay_rad_s: float,
    line_share: float,
) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.float64]]:
    """Candidate poles in the misfit of a fit, and the share of orders each was seen at.

    Parameters
    ----------
    data
        The FRFs, one row an FRF, references fastest.
    fit
        The model so far.
    freq_hz
        (n_freq,) of the lines.
    n_ref
        References.
    decay_rad_s
        Real part of the lines.
    line_share
        Independent lines per line under the window.
    """
    left = misfit(data, fit)
    weight = data.row_weight[:, None] * data.weight
    power = np.mean(weight * np.abs(left) ** 2, axis=0)
    size = np.mean(weight * np.abs(data.values) ** 2, axis=0)
    matrix = left.reshape(-1, n_ref, freq_hz.size)
    rooted = np.sqrt(np.broadcast_to(weight, left.shape).reshape(matrix.shape).mean(axis=1))
    poles: list[npt.NDArray[np.complex128]] = []
    shares: list[npt.NDArray[np.float64]] = []
    for first, last in _places(power, size, left.shape[0], line_share):
        reach = max(_MARGIN, last - first)
        lines = slice(max(first - reach, 0), last + reach + 1)
        freq = freq_hz[lines]
        if freq.size < 2 * _MARGIN:
            continue
        table = poles_plscf(
            np.ascontiguousarray(matrix[..., lines]),
            freq,
            decay_rad_s=decay_rad_s,
            weight=np.ascontiguousarray(rooted[:, lines]),
            max_order=max(_MOST_ORDER // n_ref, 4),
        )
        found, share = candidate_poles(table, (float(freq[0]), float(freq[-1])))
        poles.append(found)
        shares.append(share)
    if not poles:
        return np.empty(0, dtype=np.complex128), np.empty(0)
    return np.concatenate(poles), np.concatenate(shares)
