"""FRFs of several measurements side by side: the same degrees of freedom, on all their lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof, FrequencyResponse

__all__ = ["MergeInput", "common_lines"]

_SAME_DIRECTION = float(np.cos(np.radians(1.0)))
_SAME_LINE = 1e-3  # of the spacing: rates and lengths that were printed
_FEWEST_LINES = 2
_SAME_DECAY = 1e-3  # of the line spacing


@dataclass(frozen=True, slots=True, kw_only=True)
class MergeInput:
    """Estimates of the same FRFs; what one does not hold is 0 in `values`, 1 in `variance`."""

    freq_hz: npt.NDArray[np.float64]  # (n_freq,)
    spacing_hz: float
    decay_rad_s: float
    values: npt.NDArray[np.complex128]  # (n_inputs, n_resp, n_ref, n_freq)
    variance: npt.NDArray[np.float64]  # likewise
    there: npt.NDArray[np.bool_]  # likewise
    n_hits: npt.NDArray[np.int64]  # (n_inputs, n_resp, n_ref)


def common_lines(frfs: Sequence[FrequencyResponse]) -> MergeInput:
    """Put FRFs side by side, in the order of the first one's degrees of freedom.

    Raises
    ------
    EstimateError
        If form, lines or window differ, they share no FRF, or one tells no variance.
    """
    first = frfs[0]
    spacing = float(np.median(np.diff(first.freq_hz)))
    for frf in frfs:
        _check(frf, first, spacing)
    number = [np.rint(frf.freq_hz / spacing).astype(np.int64) for frf in frfs]
    every = np.unique(np.concatenate(number))
    freq = np.zeros(every.size)
    for frf, lines in zip(reversed(frfs), reversed(number), strict=True):
        freq[np.searchsorted(every, lines)] = frf.freq_hz
    shape = (len(frfs), len(first.responses), len(first.references), every.size)
    values = np.zeros(shape, dtype=np.complex128)
    variance, there = np.ones(shape), np.zeros(shape, dtype=np.bool_)
    n_hits = np.zeros(shape[:3], dtype=np.int64)
    for k, (frf, lines) in enumerate(zip(frfs, number, strict=True)):
        at = np.searchsorted(every, lines)
        rows = [_place(dof, first.responses) for dof in frf.responses]
        columns = [_place(dof, first.references) for dof in frf.references]
        shared = 0
        for i, row in enumerate(rows):
            for j, column in enumerate(columns):
                if row is None or column is None:
                    continue
                values[k, row, column, at] = frf.values[i, j]
                variance[k, row, column, at] = frf.variance[i, j]
                there[k, row, column, at] = True
                n_hits[k, row, column] = frf.n_hits[i, j]
                shared += 1
        if not shared:
            raise EstimateError(
                f"posture {frf.posture!r}: wanted FRFs of the same points and directions, none of "
                f"{_names(frf)} is among {_names(first)}; merge measurements of the same points"
            )
    # A line that one FRF has from nobody is none of the matrix.
    keep = np.logical_and.reduce(there.any(axis=0), axis=(0, 1))
    if np.count_nonzero(keep) < _FEWEST_LINES:
        raise EstimateError(
            f"posture {first.posture!r}: wanted {_FEWEST_LINES} lines or more for every FRF, got "
            f"{np.count_nonzero(keep)}; merge measurements of the same points"
        )
    values, variance, there = values[..., keep], variance[..., keep], there[..., keep]
    freq = freq[keep]
    return MergeInput(
        freq_hz=freq,
        spacing_hz=spacing,
        decay_rad_s=first.decay_rad_s,
        values=values,
        variance=variance,
        there=there,
        n_hits=n_hits,
    )


def _check(frf: FrequencyResponse, first: FrequencyResponse, spacing: float) -> None:
    where = f"posture {frf.posture!r}"
    if frf.form is not first.form:
        raise EstimateError(
            f"{where}: wanted FRFs of one form, got {first.form} and {frf.form}; convert one"
        )
    own = float(np.median(np.diff(frf.freq_hz)))
    offset = np.abs(frf.freq_hz / spacing - np.rint(frf.freq_hz / spacing))
    even = np.abs(first.freq_hz / spacing - np.rint(first.freq_hz / spacing))
    if abs(own / spacing - 1.0) > _SAME_LINE or max(offset.max(), even.max()) > 0.1:
        raise EstimateError(
            f"{where}: wanted FRFs on the same lines, got lines {spacing:.6g} and {own:.6g} Hz "
            "apart; record both with one length and rate"
        )
    if abs(frf.decay_rad_s - first.decay_rad_s) > _SAME_DECAY * spacing:
        raise EstimateError(
            f"{where}: wanted FRFs under one exponential window, got decays of "
            f"{first.decay_rad_s:.4g} and {frf.decay_rad_s:.4g} 1/s; use one window for both"
        )
    if not ((frf.variance > 0.0) & np.isfinite(frf.variance)).all():
        raise EstimateError(
            f"{where}: wanted a variance for every FRF, got none for some: they came without "
            "coherence, or of a single average; export them with coherence, or merge hits"
        )


def _place(dof: Dof, among: Sequence[Dof]) -> int | None:
    for i, other in enumerate(among):
        along = float(np.dot(dof.direction, other.direction))
        if other.point == dof.point and along > _SAME_DIRECTION:
            return i
    return None


def _names(frf: FrequencyResponse) -> str:
    names = [f"{r.point} {r.label}/{q.point}" for r in frf.responses for q in frf.references]
    return ", ".join(names[:6]) + (" ..." if len(names) > 6 else "")
