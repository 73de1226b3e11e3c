"""Poles that a first fit missed, sought in what it left over.

One polynomial over a wide band resolves neither light damping nor crowded modes, and a strong
mode hides a weak one beside it. What the model leaves of the FRFs holds neither: where it stands
out of the noise, and is a visible part of the FRFs, a low-order fit of a few lines is enough.
Two modes closer than a line may have been taken for one, which leaves a misfit at that mode: a
second pole beside it is tried.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.choice import candidate_poles
from armodal.analyzer.modal.complete_parts import complete_parts
from armodal.analyzer.modal.noise import smooth_lines
from armodal.analyzer.modal.plscf import poles_plscf
from armodal.analyzer.modal.regression import ModalData, Regression, misfit

__all__ = ["residual_poles", "split_poles"]

_LEAST_SHARE = 0.05  # of the FRFs' weighted amplitude that the misfit must be: a visible mode
_LEAST_RATIO = 1.5  # of the misfit over its median
_LEAST_Z = 8.0  # standard deviations of the noise's own scatter
_HALF_WIDTH = 1  # lines over which the misfit is averaged
_SPLIT = 0.6  # half bandwidths beside a mode where a second pole is tried
_LEAST_WIDTH = 0.5  # lines, of the half bandwidth of a resonance that may be two
_MARGIN = 14  # lines on either side of where it stands out
_MOST_ORDER = 24  # twelve modes on some forty lines
_TOP = (
    0.1  # of a stretch's highest power: a narrower look where several modes make one wide stretch
)
_MOST_BANDS = 40  # a round


def _standing_out(
    power: npt.NDArray[np.float64], n_frf: int, line_share: float
) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.float64]]:
    """Lines where the misfit is more than noise makes it, and its smoothed power: (n_freq,)."""
    lines = 2 * _HALF_WIDTH + 1
    level = smooth_lines(power, _HALF_WIDTH)
    scatter = 1.0 / np.sqrt(n_frf * max(lines * line_share, 1.0))
    least = float(np.median(level)) * max(_LEAST_RATIO, 1.0 + _LEAST_Z * scatter)
    return level > least, level


def _places(
    power: npt.NDArray[np.float64],
    size: npt.NDArray[np.float64],
    n_frf: int,
    line_share: float,
) -> list[tuple[int, int]]:
    """First and last line of each stretch where the misfit stands out, most conspicuous first.

    A stretch wider than the lines looked at beside it is looked at about its highest line too.
    """
    out, level = _standing_out(power, n_frf, line_share)
    out &= level > _LEAST_SHARE**2 * smooth_lines(size, _HALF_WIDTH)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(np.int8), [0]])))
    stretches = [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]
    stretches += [_top(level, ends) for ends in stretches if ends[1] - ends[0] > _MARGIN]
    stretches.sort(key=lambda ends: -float(level[ends[0] : ends[1] + 1].max()))
    return stretches[:_MOST_BANDS]


def _top(level: npt.NDArray[np.float64], ends: tuple[int, int]) -> tuple[int, int]:
    """First and last line about the highest of a stretch."""
    first, last = ends
    highest = first + int(np.argmax(level[first : last + 1]))
    low = level < _TOP * level[highest]
    before, behind = np.flatnonzero(low[first:highest]), np.flatnonzero(low[highest : last + 1])
    return (
        first + int(before[-1]) + 1 if before.size else first,
        highest + int(behind[0]) - 1 if behind.size else last,
    )


def split_poles(
    data: ModalData, fit: Regression, freq_hz: npt.NDArray[np.float64], *, line_share: float
) -> list[complex]:
    """Poles to try one at a time beside modes that leave a misfit at their own frequency.

    A resonance narrower than a line, as the lines s = decay + j w see it, is not split: two poles
    between the same two lines cannot be told from one. Parameters are those of `residual_poles`.
    """
    left = misfit(data, fit)
    power = np.mean(data.row_weight[:, None] * data.weight * np.abs(left) ** 2, axis=0)
    out, _ = _standing_out(power, fit.n_measured, line_share)
    found: list[complex] = []
    spacing_hz = float(np.min(np.diff(freq_hz)))
    decay = float(data.s[0].real)
    for pole in fit.poles:
        half_hz = -pole.real / (2.0 * np.pi)
        if half_hz + decay / (2.0 * np.pi) < _LEAST_WIDTH * spacing_hz:
            continue
        reach = max(half_hz, spacing_hz)
        if np.any(out & (np.abs(freq_hz - pole.imag / (2.0 * np.pi)) <= reach)):
            found += [complex(pole) + side * _SPLIT * 1j * -pole.real for side in (1.0, -1.0)]
    return found


def residual_poles(
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
    weight = np.broadcast_to(weight, left.shape).reshape(matrix.shape)
    parts = [
        (part, np.sqrt(weight[part].mean(axis=1)))
        for part in complete_parts(fit.measured.reshape(-1, n_ref))
    ]
    poles: list[npt.NDArray[np.complex128]] = []
    shares: list[npt.NDArray[np.float64]] = []
    for first, last in _places(power, size, fit.n_measured, line_share):
        reach = max(_MARGIN, last - first)
        lines = slice(max(first - reach, 0), last + reach + 1)
        freq = freq_hz[lines]
        if freq.size < 2 * _MARGIN:
            continue
        for part, rooted in parts:
            own = np.ascontiguousarray(matrix[..., lines][part])
            table = poles_plscf(
                own,
                freq,
                decay_rad_s=decay_rad_s,
                weight=np.ascontiguousarray(rooted[:, lines]),
                max_order=max(_MOST_ORDER // own.shape[1], 4),
            )
            found, share = candidate_poles(table, (float(freq[0]), float(freq[-1])))
            poles.append(found)
            shares.append(share)
    if not poles:
        return np.empty(0, dtype=np.complex128), np.empty(0)
    return np.concatenate(poles), np.concatenate(shares)
