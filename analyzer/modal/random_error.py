"""Random error of averaged FRFs: from coherence, and from the scatter between hits."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["coherence_random_error", "typical_random_errors"]

_Real = npt.NDArray[np.float64]


def coherence_random_error(coherence: npt.ArrayLike, n_averages: int) -> _Real:
    """Relative standard deviation of the magnitude of H1, and of its phase in radians.

    sqrt((1 - g2) / (2 g2 (n - 1))): the published formula has n for n - 1, which matters below
    some twenty averages, where the estimated coherence of n averages exceeds the true one.

    Parameters
    ----------
    coherence
        Ordinary coherence of any shape, in [0, 1].
    n_averages
        Records averaged, 2 or more; with one the coherence is 1 whatever the noise.

    Raises
    ------
    EstimateError
        If there are fewer than two averages or a coherence lies outside [0, 1].

    References
    ----------
    Bendat and Piersol, Random Data, 4th ed. (2010), Eq. (9.73), Table 9.6.

    Examples
    --------
    >>> round(float(coherence_random_error(0.9, 10)), 4)
    0.0786
    """
    g2 = np.asarray(coherence, dtype=np.float64)
    if n_averages < 2:
        raise EstimateError(
            f"the random error from coherence needs two averages or more, got {n_averages}; "
            "with one the coherence is 1 whatever the noise"
        )
    if np.any((g2 < 0.0) | (g2 > 1.0 + 1e-6)):
        raise EstimateError(
            f"coherence must lie in [0, 1], got {np.nanmin(g2):.3g} to {np.nanmax(g2):.3g}; "
            "rebuild it from the hits"
        )
    g2 = np.maximum(np.minimum(g2, 1.0), np.finfo(float).tiny)
    result: _Real = np.sqrt((1.0 - g2) / (2.0 * g2 * (n_averages - 1)))
    return result


def typical_random_errors(frf: FrequencyResponse) -> tuple[float | None, float | None]:
    """Median relative random error of |H|, by the scatter between hits and by coherence.

    None where the FRFs do not tell it. Half of E|error|² lies along an FRF, half across it.
    """
    size = np.abs(frf.values)
    told = (frf.variance > 0.0) & np.isfinite(frf.variance) & (size > 0.0)
    scatter = np.sqrt(0.5 * frf.variance[told]) / size[told]
    coherence = [
        coherence_random_error(frf.coherence[i, j], int(n))
        for (i, j), n in np.ndenumerate(frf.n_hits)
        if n > 1 and np.isfinite(frf.coherence[i, j]).all()
    ]
    return (
        float(np.median(scatter)) if scatter.size else None,
        float(np.median(coherence)) if coherence else None,
    )
