"""Which FRFs of a posture are meant, which are noise, and where a phase is told."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal import ModalModel, coherence_random_error
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["chosen_frfs", "noisy_frfs", "phase_told", "shown_lines"]

Bools = npt.NDArray[np.bool_]

# A phase is drawn where it is told within a right angle: four of its standard deviations.
PHASE_STD_RAD = np.pi / 8.0
# Half of the response's power is noise at a coherence of a half.
NOISE_COHERENCE = 0.5
MOST_LINES = 3000  # drawn of a curve: more than a screen has columns


def chosen_frfs(frf: FrequencyResponse, model: ModalModel) -> list[tuple[int, int, str]]:
    """Up to two FRFs that are meant: at the driving point, and the one explained worst.

    Returns
    -------
    (response, reference, what it is) of each
    """
    found: list[tuple[int, int, str]] = []
    measured = frf.measured
    for j, reference in enumerate(frf.references):
        at = [
            i
            for i, dof in enumerate(frf.responses)
            if dof.point == reference.point and measured[i, j]
        ]
        if at and not found:
            along = [abs(float(frf.responses[i].direction @ reference.direction)) for i in at]
            found.append((at[int(np.argmax(along))], j, "driving point"))
    within = (frf.freq_hz >= model.band_hz[0]) & (frf.freq_hz <= model.band_hz[1])
    error = np.where(measured & ~noisy_frfs(frf, within), model.frf_error, np.nan)
    if np.isfinite(error).any():
        row, column = divmod(int(np.nanargmax(error)), error.shape[1])
        if (row, column) not in {(a, b) for a, b, _ in found}:
            found.append((row, column, "explained worst"))
    return found


def noisy_frfs(frf: FrequencyResponse, lines: Bools) -> Bools:
    """Which FRFs are mostly noise on some lines: (n_resp, n_ref); none of untold coherence."""
    return np.asarray(np.median(frf.coherence[..., lines], axis=-1) < NOISE_COHERENCE)


def phase_told(frf: FrequencyResponse, i: int, j: int) -> Bools:
    """On which lines the coherence carries the phase; all where nothing was told of it."""
    coherence, n = frf.coherence[i, j], int(frf.n_hits[i, j])
    if n < 2 or not np.isfinite(coherence).all():
        return np.ones(coherence.shape, dtype=np.bool_)
    return np.asarray(coherence_random_error(coherence, n) < PHASE_STD_RAD)


def shown_lines(size: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """Lines to draw: all, or of each small part the highest and the lowest."""
    n = size.size
    if n <= MOST_LINES:
        return np.arange(n)
    cuts = np.linspace(0, n, MOST_LINES // 2 + 1).astype(int)
    ends = [
        first + np.array([np.argmin(size[first:end]), np.argmax(size[first:end])])
        for first, end in pairwise(cuts)
    ]
    return np.unique(np.concatenate(ends))
