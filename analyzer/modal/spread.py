"""How far a pole moves with the lines and the weights it is fitted by.

A deviation from noise alone does not cover what the choice of band and weighting changes: a
resonance that leaks or bends has another best pole on its top than on its flanks. Every run of near
modes is fitted again on few lines, weighted as the whole, and on many, all weighted alike; where
the poles move by more than the scatter of such fits explains, that is theirs as much as the noise
is.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.modal.about_modes import AboutModes, about_modes, near_runs
from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import ModalData, Regression, modal_data
from armodal.analyzer.modal.uncertainty import frequency_damping_jacobian, white_covariance

__all__ = ["pole_spread"]

_Real = npt.NDArray[np.float64]

TOGETHER = 10.0  # half bandwidths within which modes are fitted together
SURE = 1e-3  # probability of calling scatter a move
FEW, MANY = (4.0, 6), (25.0, 30)  # half bandwidths, and lines at least, on either side


def pole_spread(data: ModalData, fit: Regression, line_share: float) -> _Real:
    """Standard deviations of f and damping ratio over bands and weights: (2 n_modes,), Hz and 1.

    Parameters
    ----------
    data, fit
        The FRFs, and the common poles that are looked at.
    line_share
        Independent lines per line under the window.
    """
    result = np.zeros(2 * fit.poles.size)
    for run in near_runs(fit.poles, TOGETHER):
        own = np.array(run, dtype=np.intp)
        at = (2 * own[:, None] + np.arange(2)).ravel()
        squares = []
        for (reach, lines), alike in ((FEW, False), (MANY, True)):
            local = about_modes(
                data, fit, own, reach=reach, least_lines=lines, independent=line_share >= 1.0
            )
            squares.append(_moved(_alike(local) if alike else local.data, fit, own, line_share))
        result[at] = np.sqrt(np.mean(squares, axis=0))
    return result


def _alike(local: AboutModes) -> ModalData:
    """The same lines, every line of an FRF weighted as the others."""
    variance = np.exp(np.mean(np.log(local.variance), axis=1, keepdims=True))
    shape = local.data.values.shape
    return modal_data(
        local.data.form, local.data.s, local.data.values, np.broadcast_to(variance, shape)
    )


def _moved(data: ModalData, fit: Regression, own: npt.NDArray[np.intp], line_share: float) -> _Real:
    """Squared moves of (f, damping) of each mode, beyond the scatter of this fit: (2 n,)."""
    again = refine_poles(data, fit.poles[own])
    before, after = (
        np.stack([np.abs(p) / (2.0 * np.pi), -p.real / np.abs(p)], axis=1).ravel()
        for p in (fit.poles[own], again.poles)
    )
    n_frf, n_freq, n = again.n_measured, data.s.size, own.size
    free = n_frf * (2 * n_freq - 2 * n - data.n_terms) - 2 * n
    theta = white_covariance(
        again.information.sum(axis=0), float(again.cost.sum()) / max(free, 1), line_share
    )
    J = frequency_damping_jacobian(again.poles)
    scatter = np.diag(J @ theta @ J.T)
    moved = (after - before) ** 2
    beyond: _Real = np.where(scipy.special.chdtrc(1, moved / scatter) < SURE, moved - scatter, 0.0)
    return beyond
