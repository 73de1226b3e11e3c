"""Covariance of fitted poles from the scatter between measured points.

The lines of one FRF are correlated (exponential window), the axes of one hit are correlated, and
a model always lacks something: a covariance from line variances alone would be too small. Each
measured point, with all its axes and lines, is therefore one cluster, and the covariance is the
cluster-robust one with the bias reduction and the degrees of freedom of Bell and McCaffrey.

With A_g and s_g the information and the score of cluster g after the residues are projected out,
A = sum A_g, S_g = A_g^(1/2):

    cov = A^-1 [ sum_g t_g t_g^T ] A^-1,  t_g = S_g (I - S_g A^-1 S_g)^(-1/2) S_g^-1 s_g

Participations that several references share are parameters too; the score and the information of
the poles are then those left after their projection on the participations.

A mode that few points see leaves few degrees of freedom. Each variance is therefore drawn towards
the white-noise variance (A^-1), scaled by the factor by which the robust variances of all modes
exceed theirs, with the weight of four degrees of freedom; the correlations stay the robust ones.
Of a contrast that one cluster holds all but alone, the others show no scatter: the robust variance
counts by the share of the white one that it shows, and without such a share the white one stands.
With fewer than three clusters that carry information the white-noise covariance stands alone,
scaled by the lack of fit and by the correlation of neighbouring lines, with the degrees of freedom
of the hits' scatter.

References
----------
Bell and McCaffrey, Survey Methodology 28 (2002) 169. Pustejovsky and Tipton, J. Bus. Econ. Stat.
36 (2018) 672.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.rank_one import RankOneFit

__all__ = [
    "PoleCovariance",
    "frequency_damping_jacobian",
    "pole_covariance",
    "white_covariance",
    "with_spread",
]

_PRIOR_DOF = 4.0
_LONE = 0.99  # of a contrast's information in one cluster: its scatter is then the others' noise
_LEAST_INFORMATION = 0.01  # of what the most telling cluster carries
_FEWEST_DOF = 1.0  # of all contrasts together, to tell that errors are smaller than white ones


@dataclass(frozen=True, slots=True, kw_only=True)
class PoleCovariance:
    """Covariance of (f_1, zeta_1, f_2, zeta_2, ...) and Student-t degrees of freedom of each."""

    covariance: npt.NDArray[np.float64]  # (2 n_modes, 2 n_modes), Hz and 1
    dof: npt.NDArray[np.float64]  # (2 n_modes,)
    robust: bool  # from clusters; False: from line variances
    theta: npt.NDArray[np.float64]  # (n_theta, n_theta) of the poles' parts and participations


def frequency_damping_jacobian(
    poles: npt.NDArray[np.complex128],
) -> npt.NDArray[np.float64]:
    """Derivative of (f, zeta) of each pole by (Re p, Im p): (2 n, 2 n), block diagonal."""
    n = poles.size
    magnitude = np.abs(poles)
    J = np.zeros((n, 2, n, 2))
    i = np.arange(n)
    J[i, 0, i, 0] = poles.real / magnitude / (2.0 * np.pi)
    J[i, 0, i, 1] = poles.imag / magnitude / (2.0 * np.pi)
    # zeta = -Re p / |p|
    J[i, 1, i, 0] = -(poles.imag**2) / magnitude**3
    J[i, 1, i, 1] = poles.real * poles.imag / magnitude**3
    return J.reshape(2 * n, 2 * n)


def white_covariance(
    information: npt.NDArray[np.float64], lack_of_fit: float, share: float
) -> npt.NDArray[np.float64]:
    """Covariance of the parameters for independent errors, scaled by the lack of fit.

    Parameters
    ----------
    information
        (n, n) of all FRFs, residues projected out.
    lack_of_fit
        Weighted misfit per real degree of freedom; a half for noise of the stated variance.
    share
        Independent lines per line under the window.
    """
    return _inverse(information) * lack_of_fit / share


def _inverse(A: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Inverse of an information matrix; zero for parameters without information.

    What is left after a projection may be zero, or below by rounding.
    """
    own = np.diag(A)
    seen = own > np.finfo(float).tiny
    scale = np.where(seen, 1.0 / np.sqrt(np.where(seen, own, 1.0)), 0.0)
    inner = np.linalg.pinv(A * scale[:, None] * scale[None, :], hermitian=True)
    return np.asarray(inner * scale[:, None] * scale[None, :], dtype=np.float64)


def _cluster_parts(
    fit: RankOneFit, clusters: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Information and score of the poles per cluster, participations projected out."""
    n = int(clusters.max()) + 1
    member = (clusters[None, :] == np.arange(n)[:, None]).astype(float)
    A = np.tensordot(member, fit.information, axes=1)
    s = member @ fit.score
    p = 2 * fit.poles.size
    if A.shape[1] > p:
        total = A.sum(axis=0)
        Z = np.hstack([np.eye(p), -total[:p, p:] @ _inverse(total[p:, p:])])
        A, s = Z @ A @ Z.T, s @ Z.T
    return A, s


def pole_covariance(
    fit: RankOneFit,
    clusters: npt.NDArray[np.int64],
    *,
    lack_of_fit: float,
    share: float,
    hit_dof: float,
) -> PoleCovariance:
    """Covariance of frequencies and damping ratios.

    Parameters
    ----------
    fit
        The maximum-likelihood model.
    clusters
        (n_resp,), which cluster each response of the fit belongs to, from 0.
    lack_of_fit
        Weighted misfit per real degree of freedom.
    share
        Independent lines per line under the window.
    hit_dof
        Degrees of freedom of the hits' scatter, for the fall-back.

    Returns
    -------
    PoleCovariance
    """
    n_par = 2 * fit.poles.size
    J = frequency_damping_jacobian(fit.poles)
    if n_par == 0:
        return PoleCovariance(
            covariance=np.zeros((0, 0)), dof=np.zeros(0), robust=True, theta=np.zeros((0, 0))
        )
    theta = white_covariance(fit.information.sum(axis=0), lack_of_fit, share)
    white = J @ theta[:n_par, :n_par] @ J.T
    fallback = PoleCovariance(
        covariance=white, dof=np.full(n_par, hit_dof), robust=False, theta=theta
    )
    A_g, s_g = _cluster_parts(fit, clusters)
    # Scaled so that A is the identity: every expression below is then in units of information.
    A = A_g.sum(axis=0)
    if np.min(np.diag(A)) <= np.finfo(float).tiny:
        return fallback
    value, vector = np.linalg.eigh(A * _outer_scale(A))
    if value[0] <= 1e-12 * value[-1]:
        return fallback
    scale = 1.0 / np.sqrt(np.diag(A))
    whiten = scale[:, None] * vector / np.sqrt(value)  # columns; whiten^T A whiten = I
    B = whiten.T @ A_g @ whiten  # (n, p, p), sums to I
    r = s_g @ whiten
    leverage, basis = np.linalg.eigh(0.5 * (B + B.transpose(0, 2, 1)))
    leverage = np.clip(leverage, 0.0, 1.0)
    carried = leverage.max(axis=1)
    if np.count_nonzero(carried > _LEAST_INFORMATION * carried.max()) < 3:
        return fallback
    # S (I - S S)^(-1/2) S^-1 shares the eigenvectors of B; a direction seen by one cluster all but
    # alone carries no information on its scatter and is left out.
    lone = leverage > _LONE
    factor = np.where(lone, 0.0, 1.0 / np.sqrt(np.where(lone, 1.0, 1.0 - leverage)))
    t = np.einsum("gij,gj->gi", basis * factor[:, None, :], np.einsum("gji,gj->gi", basis, r))
    map_out = J @ whiten  # contrasts in whitened parameters
    covariance = map_out @ (t.T @ t) @ map_out.T
    drawn, dof = _drawn_together(covariance, white, _seen(map_out, leverage, basis, factor))
    return PoleCovariance(
        covariance=drawn, dof=dof, robust=True, theta=_stretched(theta, J, drawn, white)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Seen:
    """What the clusters' scatter tells of each contrast under a white working model."""

    share: npt.NDArray[np.float64]  # (n,) of its variance, 1 where no direction is left out
    dof: npt.NDArray[np.float64]  # (n,) degrees of freedom of that share


def _drawn_together(
    robust: npt.NDArray[np.float64], white: npt.NDArray[np.float64], seen: _Seen
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Robust covariance with its variances drawn towards the scaled white ones, and its dof."""
    tiny = np.finfo(float).tiny
    own = np.diag(robust)
    model = np.maximum(np.diag(white), tiny)
    whole = own / np.maximum(seen.share, tiny)  # a variance of which a share was seen
    dof = seen.share * seen.dof
    excess = float(np.sum(dof * whole / model) / max(np.sum(dof), tiny))
    if np.sum(dof) < _FEWEST_DOF:
        excess = max(excess, 1.0)
    variance = (dof * whole + _PRIOR_DOF * excess * model) / (dof + _PRIOR_DOF)
    shown = np.sqrt(np.where(own > 0.0, own, 1.0))
    correlation = robust / np.outer(shown, shown)
    np.fill_diagonal(correlation, 1.0)
    return correlation * np.sqrt(np.outer(variance, variance)), dof + _PRIOR_DOF


def _stretched(
    theta: npt.NDArray[np.float64],
    J: npt.NDArray[np.float64],
    robust: npt.NDArray[np.float64],
    white: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """White covariance of all parameters, stretched to the robust variances of the poles.

    The participations are stretched by the mean factor of all poles.
    """
    n = J.shape[0]
    ratio = np.sqrt(np.diag(robust) / np.maximum(np.diag(white), np.finfo(float).tiny))
    D = np.eye(theta.shape[0]) * float(np.sqrt(np.mean(ratio**2)))
    D[:n, :n] = np.linalg.solve(J, ratio[:, None] * J)
    result: npt.NDArray[np.float64] = D @ theta @ D.T
    return result


def _outer_scale(A: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    scale = 1.0 / np.sqrt(np.diag(A))
    return scale[:, None] * scale[None, :]


def _seen(
    contrasts: npt.NDArray[np.float64],
    leverage: npt.NDArray[np.float64],
    basis: npt.NDArray[np.float64],
    factor: npt.NDArray[np.float64],
) -> _Seen:
    """Expected share and Satterthwaite's degrees of freedom of each contrast's robust variance.

    dof = (tr M)^2 / tr(M M), M_gh = delta_gh b_g.b_g - b_g^T S_g S_h b_h with
    b_g = (I - S_g S_g)^(-1/2) S_g c, A the identity; tr M is the expected robust variance.
    """
    tiny = np.finfo(float).tiny
    root = np.sqrt(leverage)
    dof, share = np.empty(contrasts.shape[0]), np.empty(contrasts.shape[0])
    for i, c in enumerate(contrasts):
        in_basis = np.einsum("gji,j->gi", basis, c)
        b = factor * root * in_basis
        projected = np.einsum("gij,gj->gi", basis, root * b)
        M = np.diag(np.sum(b**2, axis=1)) - projected @ projected.T
        dof[i] = np.trace(M) ** 2 / max(float(np.sum(M * M)), tiny)
        share[i] = np.trace(M) / max(float(c @ c), tiny)
    return _Seen(share=np.clip(share, 0.0, 1.0), dof=dof)


def with_spread(precision: PoleCovariance, spread: npt.NDArray[np.float64]) -> PoleCovariance:
    """Covariance with what else moves the poles, independent of the noise: std (2 n_modes,)."""
    return replace(precision, covariance=precision.covariance + np.diag(spread**2))
