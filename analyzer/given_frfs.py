"""What FRFs averaged elsewhere tell of their scatter: a variance, or else coherence and averages.

The coherence of n averages gives each line's scatter as single hits do (`coherence_noise`), and it
is smoothed and drawn towards a model alike: a noise level that varies slowly over the lines, and an
error in proportion to the FRF.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from armodal.analyzer.coherence_noise import CoherenceNoise, coherence_noise
from armodal.analyzer.modal.noise import (
    SMOOTHED_LINES,
    hit_scatter_variance,
    independent_line_share,
    smooth_lines,
)
from armodal.analyzer.time_order import in_time_order
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["complete_points", "with_variance", "with_variances"]

_VERY_FEW = 3  # averages: a line knows its noise to no better than 70 %
_FEWEST = 2  # averages that a coherence below one needs


def with_variances(session: Session) -> Session:
    """Return the session with its given FRFs in order of time, with variance by coherence."""
    turned = [in_time_order(frf) for frf in session.frfs]
    said = [f"posture {frf.posture!r}: {note}" for frf, note in turned if note]
    found = [_with_variance(frf) for frf, _ in turned]
    said += [f"posture {frf.posture!r}: {note}" for frf, notes in found for note in notes]
    return replace(
        session,
        frfs=tuple(frf for frf, _ in found),
        warnings=(*session.warnings, *said),
    )


def complete_points(frf: FrequencyResponse) -> FrequencyResponse:
    """Responses of the points at which every FRF was measured.

    Raises
    ------
    EstimateError
        If there is no such point.
    """
    lacking = np.flatnonzero(~frf.measured.all(axis=1))
    if not lacking.size:
        return frf
    points = {frf.responses[i].point for i in lacking}
    rows = [i for i, dof in enumerate(frf.responses) if dof.point not in points]
    if not rows:
        raise EstimateError(
            f"posture {frf.posture!r}: wanted a point that was measured over every reference, "
            "every point lacks an FRF; import the references as postures of their own"
        )
    return replace(
        frf,
        values=frozen_array(frf.values[rows], np.complex128),
        coherence=frozen_array(frf.coherence[rows], np.float64),
        variance=frozen_array(frf.variance[rows], np.float64),
        n_hits=frozen_array(frf.n_hits[rows], np.int64),
        responses=tuple(frf.responses[i] for i in rows),
    )


def with_variance(frf: FrequencyResponse) -> FrequencyResponse:
    """Return FRFs with the variance that coherence and number of averages tell.

    Parameters
    ----------
    frf
        FRFs with coherence NaN where it is not told and `n_hits` 0 where the averages are not.
        A coherence above 1 shows how wrong it is on other lines too, and is then cut to 1.

    Returns
    -------
    FrequencyResponse
        A variance that came with the FRFs stays. Else that of the coherence, as for two averages
        (an upper bound) where their number is not told; of FRFs without a coherence the relative
        one of those that have it, smoothed over lines; 0 (not told) where no coherence tells it;
        infinite where not measured.
    """
    return _with_variance(frf)[0]


def _with_variance(frf: FrequencyResponse) -> tuple[FrequencyResponse, tuple[str, ...]]:
    """FRFs with variance, and what is to be said of their coherence."""
    cut = frozen_array(np.minimum(frf.coherence, 1.0), np.float64)
    came = np.all(np.isfinite(frf.variance) & (frf.variance > 0.0), axis=-1)
    if came.all():
        return replace(frf, coherence=cut), ()
    n_hits = np.where(frf.n_hits == 0, _FEWEST, frf.n_hits)
    magnitude = np.abs(frf.values) ** 2
    found = {
        at: coherence_noise(magnitude[at], frf.coherence[at], int(n))
        for at, n in np.ndenumerate(n_hits)
        if np.isfinite(frf.coherence[at]).all() and not came[at]
    }
    noise = {at: one for at, one in found.items() if one is not None}
    notes = tuple(_notes(frf, found))
    if not noise and not came.any():
        return replace(frf, coherence=cut), notes
    told = np.zeros(n_hits.shape, dtype=bool)
    scatter, level = np.zeros_like(magnitude), np.zeros_like(magnitude)
    for at, one in noise.items():
        told[at], scatter[at], level[at] = True, one.scatter, one.level
    share = independent_line_share(frf.decay_rad_s, float(np.min(np.diff(frf.freq_hz))))
    variance = np.where(came[..., None], frf.variance, 0.0)
    if noise:
        # As FRFs of one reference: relative scatter is shared by those that tell one.
        variance[told] = hit_scatter_variance(
            scatter[told][:, None],
            level[told][:, None],
            magnitude[told][:, None],
            n_hits[told][:, None],
            share,
        )[:, 0]
    told |= came
    relative = np.median(variance[told].sum(axis=-1) / magnitude[told].sum(axis=-1))
    like_the_others = relative * smooth_lines(magnitude, SMOOTHED_LINES)
    variance = np.where(told[..., None], variance, like_the_others)
    variance[~frf.measured] = np.inf
    return replace(frf, variance=frozen_array(variance, np.float64), coherence=cut), notes


def _notes(
    frf: FrequencyResponse, found: Mapping[tuple[int, ...], CoherenceNoise | None]
) -> Iterator[str]:
    """What is to be known of coherences."""
    told = [one for one in found.values() if one is not None]
    silent = [at for at, one in found.items() if one is None and frf.n_hits[at] != 1]
    if silent:
        yield (
            f"{len(silent)} FRFs have a coherence of 1 on every line: it says nothing about their "
            "noise"
        )
    coarse = [one for one in told if one.unseen > 0.0]
    if coarse:
        highest = max(float(frf.coherence[at].max()) for at, one in found.items() if one)
        yield (
            f"{len(coarse)} FRFs have a coherence that is known to "
            f"{np.median([one.resolution for one in coarse]):.2g} only (clipped, rounded or above "
            f"1; it reaches {highest:.4g}): on "
            f"{100.0 * np.mean([one.unseen for one in coarse]):.2g} % of their lines the noise is "
            "less, and is taken from the lines around"
        )
    few = frf.n_hits[frf.n_hits > 1].min(initial=np.iinfo(np.int64).max)
    if told and few <= _VERY_FEW:
        yield (
            f"coherences of {few} averages: pure noise would read {1.0 / few:.2f}, and a line's "
            f"noise is known to {100.0 / np.sqrt(few - 1.0):.0f} % only; that bias is taken off, "
            "and the noise is averaged over lines"
        )
