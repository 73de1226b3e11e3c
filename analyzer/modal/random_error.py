"""Random error of an averaged FRF: from its coherence, and from the scatter between hits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import special

from armodal.analyzer.modal.noise import smooth_lines
from armodal.protocols.errors import EstimateError

__all__ = ["RandomError", "coherence_random_error", "scatter_random_error"]

_Real = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomError:
    """Standard deviation of an FRF's magnitude on every line, from few hits.

    The phase in radians has the same standard deviation as the magnitude has relatively.
    """

    std: _Real  # (n_axes, n_freq), in the FRF's unit
    dof: float  # Student-t degrees of freedom of `std`

    def half_width(self, level: float = 0.95) -> _Real:
        """Half of the two-sided interval: (n_axes, n_freq)."""
        result: _Real = float(special.stdtrit(self.dof, 0.5 + 0.5 * level)) * self.std
        return result


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


def scatter_random_error(
    frfs: npt.NDArray[np.complex128],
    force_power: _Real,
    *,
    half_width_lines: int = 4,
    independent_share: float = 1.0,
) -> RandomError:
    """Standard deviation of |H1| from the scatter of its single hits.

    n hits leave 2 (n - 1) real degrees of freedom a line: four for three hits. The variance is
    the mean over neighbouring lines, which multiplies them by the independent lines among these.

    Parameters
    ----------
    frfs
        (n_hits, n_axes, n_freq) of one sensor point and reference.
    force_power
        (n_hits, n_freq), |F|^2, the weights of the average.
    half_width_lines
        Lines on either side that are averaged over.
    independent_share
        Independent lines per line, see `independent_line_share`.

    Raises
    ------
    EstimateError
        If there are fewer than two hits.
    """
    n = frfs.shape[0]
    if n < 2:
        raise EstimateError(f"the scatter between hits needs two hits or more, got {n}; hit again")
    weight = force_power[:, None, :]
    total = weight.sum(axis=0)
    mean = (weight * frfs).sum(axis=0) / total
    scatter = (weight * np.abs(frfs - mean) ** 2).sum(axis=0) / ((n - 1) * total)
    # Half of E|error|^2 lies along the FRF, half across it.
    std = np.sqrt(0.5 * smooth_lines(scatter, half_width_lines))
    lines = 1.0 + 2.0 * half_width_lines * independent_share
    return RandomError(std=std, dof=2.0 * (n - 1) * lines)
