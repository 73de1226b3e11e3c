"""What a mode is worth beside the noise about it.

The misfit is not the same everywhere: where a strong resonance leaks or moves, the model's error is
far above what is left between resonances. A mode is held against the misfit on the lines that tell
of it, not against that of the whole band.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.peaks import SURROUNDINGS
from armodal.analyzer.modal.regression import ModalData, Regression, misfit

__all__ = ["LEAST_SIGNIFICANCE", "lack_of_fit", "noise_about", "significance", "worth"]

LEAST_SIGNIFICANCE = 5.0  # of a gain over what noise gives: beyond doubt


def lack_of_fit(fit: Regression, n_freq: int) -> float:
    """Weighted misfit per real degree of freedom; a half for noise of the stated variance."""
    n_frf, n_modes = fit.n_measured, fit.poles.size
    free = max(n_frf * (2 * n_freq - 2 * n_modes - fit.residuals.shape[1]) - 2 * n_modes, 1)
    return float(np.sum(fit.cost) / free)


def noise_about(data: ModalData, fit: Regression) -> npt.NDArray[np.float64]:
    """Weighted misfit per real degree of freedom on the lines that tell of each mode: (n_modes,).

    The mean over all lines, weighted with the resonance's own power 1/|s - p|^2, wider by half the
    surroundings that a peak is held against: a mode takes up the misfit of fewer lines itself.
    """
    power = np.sum(data.row_weight[:, None] * data.weight * np.abs(misfit(data, fit)) ** 2, axis=0)
    mean = float(np.mean(power))
    # Of FRFs without noise rounding is left, or by chance nothing.
    least = np.finfo(float).eps ** 2 * float(data.energy.sum()) / (2 * data.values.size)
    if mean <= 0.0:
        return np.full(fit.poles.size, least)
    omega = data.s.imag
    wide = SURROUNDINGS / 2.0 * float(np.median(np.diff(omega))) - fit.poles.real
    share = 1.0 / ((omega - fit.poles.imag[:, None]) ** 2 + wide[:, None] ** 2)
    local = (share @ power) / share.sum(axis=1) / mean
    result: npt.NDArray[np.float64] = np.maximum(local * lack_of_fit(fit, omega.size), least)
    return result


def significance(
    fit: Regression, noise: npt.NDArray[np.float64], line_share: float
) -> npt.NDArray[np.float64]:
    """Gain of each mode over what noise with correlated lines would give: (n_modes,).

    `noise` is that of `noise_about`.
    """
    expected = 2.0 * fit.n_measured * noise / line_share
    result: npt.NDArray[np.float64] = fit.gain.sum(axis=0) / expected
    return result


def worth(n_frf: int, noise: float, line_share: float) -> float:
    """Fall of the misfit that one more mode, with a pole of its own, must bring."""
    return LEAST_SIGNIFICANCE * noise * (2.0 * n_frf + 2.0) / line_share
