"""What the coherence of FRFs averaged elsewhere says about their scatter.

With n averages the H1 estimate leaves sum|X - H F|^2 = (1 - gamma^2) sum|X|^2, so that its scatter
is

    sum|X - H F|^2 / ((n - 1) sum|F|^2) = |H|^2 (1 - gamma^2) / (gamma^2 (n - 1)),

the very quantity that single hits give, and it is smoothed and drawn towards a model alike.

References
----------
Bendat and Piersol, Random Data, 4th ed. (2010), Eqs. (6.59), (9.73).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.modal.noise import hit_scatter_variance, independent_line_share, smooth_lines
from armodal.analyzer.time_order import in_time_order
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["complete_points", "with_variance", "with_variances"]

_LEAST_COHERENCE = 1e-6
_FLOOR = 1e-10  # of |H|^2: five digits are as good as any analyser's calibration
_HALF_WIDTH = 4  # lines, as the scatter of hits is smoothed
_FEWEST = 2  # averages that a coherence below one needs


def with_variances(session: Session) -> Session:
    """Return the session with its given FRFs in order of time, with variance by coherence."""
    turned = [in_time_order(frf) for frf in session.frfs]
    said = [f"posture {frf.posture!r}: {note}" for frf, note in turned if note]
    return replace(
        session,
        frfs=tuple(with_variance(frf) for frf, _ in turned),
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

    Returns
    -------
    FrequencyResponse
        Variance as for two averages (an upper bound) where their number is not told; of FRFs
        without a coherence the relative one of those that have it, smoothed over lines; 0 (not
        told) where none has one, or there was a single average; infinite where not measured.
    """
    told = np.isfinite(frf.coherence).all(axis=-1) & (frf.n_hits != 1)
    if not told.any():
        return frf
    n_hits = np.where(frf.n_hits == 0, _FEWEST, frf.n_hits)
    coherence = np.where(told[..., None], frf.coherence, 1.0)
    coherence = np.clip(coherence, _LEAST_COHERENCE, 1.0)
    magnitude = np.abs(frf.values) ** 2
    several = np.maximum(n_hits - 1, 1)[..., None]
    scatter = magnitude * (1.0 - coherence) / (coherence * several)
    share = independent_line_share(frf.decay_rad_s, float(np.min(np.diff(frf.freq_hz))))
    variance = hit_scatter_variance(scatter, _FLOOR * magnitude, magnitude, n_hits, share)
    relative = np.median(variance[told].sum(axis=-1) / magnitude[told].sum(axis=-1))
    like_the_others = relative * smooth_lines(magnitude, _HALF_WIDTH)
    variance = np.where(told[..., None], variance, like_the_others)
    variance[~frf.measured] = np.inf
    return replace(frf, variance=frozen_array(variance, np.float64))
