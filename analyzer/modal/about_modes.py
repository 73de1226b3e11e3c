"""The lines about some modes, the other modes taken off: a small problem of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.regression import ModalData, Regression, modal_data

__all__ = ["AboutModes", "about_modes", "linked_runs", "near_runs"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]

ENOUGH_LINES = 32  # within a half bandwidth
WIDER = 2.0  # a copy for mountings that differ, than one for those that agree


@dataclass(frozen=True, slots=True, kw_only=True)
class AboutModes:
    """FRFs on the lines about some modes."""

    data: ModalData
    variance: _Real  # (n_frf, n_lines)
    core: _Real  # (n_modes, n_lines), 1 within a half bandwidth of each mode, else 0

    def of(self, member: npt.NDArray[np.bool_], *, every: int = 1) -> ModalData:
        """Some of the FRFs (n_frf,), on one line of so many."""
        data, at = self.data, slice(None, None, every)
        return modal_data(data.form, data.s[at], data.values[member, at], self.variance[member, at])


def near_runs(poles: _Complex, within: float) -> list[list[int]]:
    """Indices by frequency, in runs whose neighbours are within so many half bandwidths."""
    runs: list[list[int]] = []
    for i in np.argsort(poles.imag):
        if runs:
            before = poles[runs[-1][-1]]
            if poles[i].imag - before.imag < within * max(-before.real, -poles[i].real):
                runs[-1].append(int(i))
                continue
        runs.append([int(i)])
    return runs


def linked_runs(poles: _Complex, within: float) -> list[list[int]]:
    """Indices in runs by frequency, in which every pole may be a copy of another of its run.

    Such are two poles within so many half bandwidths, frequency and decay together: of the wider,
    but no more than WIDER times the narrower. A wide pole that rounds off the background is no copy
    of what stands in it.
    """
    runs: list[list[int]] = []
    half = -poles.real
    for i in (int(k) for k in np.argsort(poles.imag)):
        width = np.minimum(np.maximum(half, half[i]), WIDER * np.minimum(half, half[i]))
        alike = np.abs(poles - poles[i]) < within * width
        joined = [run for run in runs if np.any(alike[run])]
        runs = [run for run in runs if not np.any(alike[run])]
        runs.append(sorted([k for run in joined for k in run] + [i], key=lambda k: poles[k].imag))
    return sorted(runs, key=lambda run: float(poles[run[0]].imag))


def about_modes(
    data: ModalData,
    fit: Regression,
    own: npt.NDArray[np.intp],
    *,
    reach: float,
    least_lines: int,
    independent: bool = False,
) -> AboutModes:
    """Lines about some modes of a fit, the others taken off.

    What is not yet known of the others stands about them: lines nearer to them are theirs.
    Independent lines far closer than the modes are wide are averaged, a few at a time: with so many
    left within a half bandwidth that changes the resonance by a ten-thousandth.

    Parameters
    ----------
    data, fit
        All lines, and all modes.
    own
        Which modes.
    reach
        Half bandwidths of the widest of them, on either side.
    least_lines
        On either side.
    independent
        Whether noise differs from line to line, as it does without an exponential window.
    """
    others = np.setdiff1d(np.arange(fit.poles.size), own)
    omega, poles = data.s.imag, fit.poles[own]
    half, step = -poles.real, float(np.median(np.diff(omega)))
    away = np.abs(omega - poles.imag[:, None])
    beside = np.abs(omega - fit.poles[others].imag[:, None]).min(axis=0, initial=np.inf)
    near = away.min(axis=0)
    within = (near <= reach * float(half.max())) & (near <= beside)
    lines = within | (near <= least_lines * step)
    s = data.s[lines]
    values = data.values[:, lines]
    if others.size:
        both = np.concatenate([fit.residues[:, others], fit.residues[:, others].conj()], axis=1)
        p = np.concatenate([fit.poles[others], fit.poles[others].conj()])
        values = values - both @ (1.0 / (s - p[:, None]))
    if data.background.size:
        values = (
            values
            - fit.residuals[:, -2 * data.background.size :]
            @ (data.terms[-2 * data.background.size :, lines])
        )
    variance = data.variance_on(lines)
    every = int(np.min(half) / step) // ENOUGH_LINES if independent else 1
    if every > 1:
        first = _firsts(np.flatnonzero(lines), every)
        count = np.diff(np.append(first, s.size))
        s = np.asarray(np.add.reduceat(s, first) / count, dtype=np.complex128)
        values = np.asarray(np.add.reduceat(values, first, axis=1) / count, dtype=np.complex128)
        variance = np.add.reduceat(variance, first, axis=1) / count**2
    away = np.abs(s.imag - poles.imag[:, None])
    return AboutModes(
        data=modal_data(data.form, s, values, variance),
        variance=variance,
        core=(away <= np.maximum(half, step)[:, None]).astype(np.float64),
    )


def _firsts(lines: npt.NDArray[np.intp], every: int) -> npt.NDArray[np.intp]:
    """First places of groups of up to `every` neighbouring lines."""
    begins = np.concatenate([[0], np.flatnonzero(np.diff(lines) > 1) + 1])
    lengths = np.diff(np.append(begins, lines.size))
    within = np.arange(lines.size) - np.repeat(begins, lengths)
    return np.flatnonzero(within % every == 0)
