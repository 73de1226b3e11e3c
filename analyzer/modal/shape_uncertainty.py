"""Standard deviations of mode shapes, from the scatter that was measured.

With A the poles and participations (covariance C from `uncertainty`), a shape's error is

    d phi_o = N_o^-1 e_o + S_o dA,

e_o the noise of the FRFs of response o, N_o the information they carry on it, both from
`rank_one`. The axes of one hit share part of their noise: their correlation is measured on what
the fit leaves, E_o / sigma_o averaged over all lines, and enters between the responses of one
point. The shape handed out is turned and scaled, s = phi e^(-j alpha) / |phi_k|, with
alpha = arg(sum phi_i^2) / 2 its best line and k its largest entry, so that

    ds_o = eps_o - j s_o Im(sum s_i eps_i / sum s_i^2) - s_o Re(eps_k / s_k),

eps = d phi e^(-j alpha) / |phi_k|: what is common to all entries is no error of the shape.

A hit that lands beside its point, or askew, multiplies a mode's part in all its FRFs by one real
factor: the fit leaves nothing of that, for the factor goes into the residue. It is seen in the
scatter between hits alone. Where a mode dominates, E|error of H|^2 from that scatter beyond the
misfit is tau^2 |H|^2, and adds tau^2 s_o s_o^T to the entries of one point.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.rank_one import RankOneFit

__all__ = [
    "axis_correlation",
    "common_gain_variance",
    "participation_covariance",
    "shape_covariance",
    "turned_std",
]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]


def axis_correlation(misfit: _Complex, clusters: npt.NDArray[np.int64]) -> _Complex:
    """Correlation of the noise of responses that share hits.

    Parameters
    ----------
    misfit
        (n_resp, n_ref, n_freq), FRF minus model over its standard deviation.
    clusters
        (n_resp,), responses of one cluster share hits.

    Returns
    -------
    (n_resp, n_resp) complex128
        Mean of misfit_i conj(misfit_j) over lines and references, unit diagonal, zero between
        clusters.
    """
    flat = misfit.reshape(misfit.shape[0], -1)
    size = np.linalg.norm(flat, axis=1)
    flat = flat / np.where(size > 0.0, size, 1.0)[:, None]
    result = np.zeros((flat.shape[0], flat.shape[0]), dtype=np.complex128)
    for cluster in np.unique(clusters):
        rows = np.flatnonzero(clusters == cluster)
        result[np.ix_(rows, rows)] = flat[rows] @ flat[rows].conj().T
    np.fill_diagonal(result, 1.0)
    return result


def common_gain_variance(
    values: _Complex, misfit: _Complex, variance: _Real, near: npt.NDArray[np.bool_]
) -> float:
    """Relative variance of a mode's size from hit to hit that the misfit does not show.

    Parameters
    ----------
    values, misfit, variance
        (n_resp, n_ref, n_freq): averaged FRFs, FRFs minus model, and E|error|^2 by the scatter
        of hits.
    near
        (n_freq,) the lines where the mode dominates.
    """
    beyond = variance[..., near] - np.abs(misfit[..., near]) ** 2
    size = float(np.sum(np.abs(values[..., near]) ** 2))
    return max(float(np.sum(beyond)) / max(size, float(np.finfo(float).tiny)), 0.0)


def shape_covariance(
    fit: RankOneFit,
    theta: _Real,
    correlation: _Complex,
    noise: float,
    mode: int,
    *,
    gain_variance: float,
    clusters: npt.NDArray[np.int64],
) -> tuple[_Real, npt.NDArray[np.float64]]:
    """Covariance of one shape as fitted, real and imaginary part of each entry interleaved.

    Parameters
    ----------
    fit
        The maximum-likelihood model.
    theta
        Covariance of its poles and participations.
    correlation
        (n_resp, n_resp) of the noise, see `axis_correlation`.
    noise
        Weighted misfit per degree of freedom and independent line.
    mode
        Which mode.
    gain_variance
        Of the factor that the entries of one point share, see `common_gain_variance`.
    clusters
        (n_resp,), the point of each response.

    Returns
    -------
    covariance, shares
        (2 n_resp, 2 n_resp), and the shares of its trace that poles and participations, noise,
        and the common factors bring.
    """
    n_resp = fit.shape.shape[0]
    at = slice(2 * mode, 2 * mode + 2)
    own = noise * fit.shape_inverse[:, at, at]
    root = np.linalg.cholesky(own + 1e-300 * np.eye(2))
    rho = np.empty((n_resp, 2, n_resp, 2))
    rho[:, 0, :, 0] = rho[:, 1, :, 1] = correlation.real
    rho[:, 1, :, 0] = correlation.imag
    rho[:, 0, :, 1] = -correlation.imag
    noisy = np.einsum("oab,obpc,pdc->oapd", root, rho, root, optimize=True)
    slope = fit.shape_slope[:, at].reshape(2 * n_resp, -1)
    shared = slope @ theta @ slope.T
    entries = np.ascontiguousarray(fit.shape[:, mode]).view(np.float64)
    same_point = np.repeat(np.repeat(clusters[:, None] == clusters, 2, axis=0), 2, axis=1)
    gain = gain_variance * np.outer(entries, entries) * same_point
    white = noisy.reshape(2 * n_resp, 2 * n_resp)
    result: _Real = white + shared + gain
    traces = np.array([np.trace(part) for part in (shared, white, gain)])
    return result, traces / traces.sum()


def participation_covariance(fit: RankOneFit, theta: _Real, mode: int) -> _Real:
    """Covariance of one mode's participations; zero for the one held: (2 n_ref, 2 n_ref)."""
    n_ref, n_modes = fit.participation.shape
    n = 2 * n_modes
    full = np.zeros((n_ref, n_modes, 2), dtype=np.int64) - 1
    free = np.ones((n_ref, n_modes), dtype=bool)
    free[fit.held, np.arange(n_modes)] = False
    full[free] = n + np.arange(2 * int(free.sum())).reshape(-1, 2)
    index = full[:, mode].reshape(-1)
    known = index >= 0
    result = np.zeros((2 * n_ref, 2 * n_ref))
    result[np.ix_(known, known)] = theta[np.ix_(index[known], index[known])]
    return result


def turned_std(vector: _Complex, covariance: _Real, turned: _Complex) -> tuple[_Complex, float]:
    """Standard deviations of a vector turned and scaled, and of the scale taken off it.

    Parameters
    ----------
    vector, covariance
        (n,) and (2 n, 2 n) as fitted.
    turned
        (n,), the vector turned to its best line, largest magnitude 1.

    Returns
    -------
    std, scale_std
        (n,) standard deviation of the real part plus j times that of the imaginary part, and the
        relative standard deviation of the largest entry's magnitude.
    """
    largest = int(np.argmax(np.abs(turned)))
    factor = turned[largest] / vector[largest]
    turn = np.array([[factor.real, -factor.imag], [factor.imag, factor.real]])
    n = vector.size
    C = covariance.reshape(n, 2, n, 2)
    C = np.einsum("ab,obpc,dc->oapd", turn, C, turn, optimize=True).reshape(2 * n, 2 * n)
    quotient = turned / np.sum(turned**2)
    V = np.zeros((2 * n, 2))  # the two common parts: turn and scale
    V[0::2, 0], V[1::2, 0] = quotient.imag, quotient.real
    V[2 * largest, 1], V[2 * largest + 1, 1] = turned[largest].real, turned[largest].imag
    U = np.empty((2 * n, 2))
    U[0::2, 0], U[1::2, 0] = -turned.imag, turned.real
    U[0::2, 1], U[1::2, 1] = turned.real, turned.imag
    CV = C @ V
    inner = V.T @ CV
    variance = np.diag(C) - 2.0 * np.sum(U * CV, axis=1) + np.sum((U @ inner) * U, axis=1)
    std = np.sqrt(np.maximum(variance, 0.0))
    result: _Complex = std[0::2] + 1j * std[1::2]
    return result, float(np.sqrt(max(inner[1, 1], 0.0)))
