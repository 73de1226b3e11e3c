"""Poly-reference least-squares complex frequency (pLSCF) estimate of poles.

Right matrix fraction H(w) = B(w) A(w)^-1 with real coefficients in z = e^(j w dt). Per response o
the weighted equation error is linear in both,

    w_o(k) [ H_o(k) sum_r A_r z^r - sum_r B_or z^r ],

and B_o is eliminated, leaving normal equations in A alone. All their blocks are Toeplitz, so each
needs only sums of w^2 H z^m over the lines. A_0 = I pushes the poles the noise asks for out of
the unit circle, where they are told apart by their negative damping.

References
----------
Guillaume et al., Proc. IMAC XXI (2003), "A poly-reference implementation of the least-squares
complex frequency-domain estimator". Cauberghe et al., Mech. Syst. Signal Process. 19 (2005) 1255,
on the constraint.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.protocols.errors import EstimateError

__all__ = ["Stabilisation", "poles_plscf"]

# Ridges relative to the diagonal. The numerators' normal matrix is nearly singular where the lines
# leave part of the circle empty; a ridge r there leaves rounding of eps / sqrt(r) in the reduction.
_NUMERATOR_RIDGE = 1e-10
_LEAST_RIDGE = 1e-15  # times ten until the reduced equations are definite


@dataclass(frozen=True, slots=True, kw_only=True)
class Stabilisation:
    """Poles over model orders, all with positive frequency inside the band.

    Row i of each array is one pole; `order` says which model it came from.
    """

    order: npt.NDArray[np.int64]  # (n_poles,)
    pole_rad_s: npt.NDArray[np.complex128]  # (n_poles,), decay of the lines added back
    participation: npt.NDArray[np.complex128]  # (n_poles, n_ref), unit norm
    orders: tuple[int, ...]  # all orders tried

    @property
    def f_hz(self) -> npt.NDArray[np.float64]:
        """Undamped natural frequencies |pole| / 2 pi."""
        result: npt.NDArray[np.float64] = np.abs(self.pole_rad_s) / (2.0 * np.pi)
        return result

    @property
    def damping_ratio(self) -> npt.NDArray[np.float64]:
        """Damping ratios, negative where the pole is unstable."""
        result: npt.NDArray[np.float64] = -self.pole_rad_s.real / np.abs(self.pole_rad_s)
        return result


@dataclass(frozen=True, slots=True, kw_only=True)
class _Zone:
    """The Nyquist zone a band is folded into, so that it fills most of a half circle."""

    dt_s: float
    number: int

    @property
    def reversed(self) -> bool:
        """Whether frequency runs backwards in the zone (every second one)."""
        return self.number % 2 == 0

    def unfold(self, z: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
        """Poles in rad/s, with positive frequency, of the roots `z` in the upper half plane."""
        log = np.log(z)
        angle = 2.0 * np.pi * (self.number // 2) + (-log.imag if self.reversed else log.imag)
        poles: npt.NDArray[np.complex128] = (log.real + 1j * angle) / self.dt_s
        return poles


def _zone(low_hz: float, high_hz: float) -> _Zone:
    """Zone `number` = 1, 2, ... of width high/number that holds the band."""
    number = max(int(high_hz // max(high_hz - low_hz, 1e-9 * high_hz)), 1)
    # The margin keeps the last line off z = -1.
    return _Zone(dt_s=number / (2.0 * high_hz * (1.0 + 0.01 / number)), number=number)


def _lag_sums(
    values: npt.NDArray[np.complex128],
    cosines: npt.NDArray[np.float64],
    sines: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """Re sum_k values z^m for m = -n..n: (..., 2 n + 1)."""
    even = values.real @ cosines
    odd = values.imag @ sines
    return np.concatenate([(even + odd)[..., :0:-1], even - odd], axis=-1)


def _real_lag_sums(
    values: npt.NDArray[np.float64], cosines: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    even = values @ cosines
    return np.concatenate([even[..., :0:-1], even], axis=-1)


def _normal_matrix(
    H: npt.NDArray[np.complex128],
    weight: npt.NDArray[np.float64],
    theta: npt.NDArray[np.float64],
    order: int,
) -> tuple[npt.NDArray[np.float64], float]:
    """Reduced normal matrix in the coefficients of A, and its mean diagonal before reduction."""
    n_resp, n_ref, _ = H.shape
    z = np.exp(1j * theta)
    powers = np.empty((theta.size, order + 1), dtype=np.complex128)
    powers[:, 0] = 1.0
    powers[:, 1:] = z[:, None]
    np.cumprod(powers, axis=1, out=powers)
    cosines, sines = np.ascontiguousarray(powers.real), np.ascontiguousarray(powers.imag)

    w2 = weight**2
    lag = np.arange(order + 1)[None, :] - np.arange(order + 1)[:, None] + order  # s - r + n
    # Weights that differ by a factor only leave one matrix R for all responses: the factor goes
    # into the FRFs.
    level = np.sqrt(w2.mean(axis=1, keepdims=True))
    shared = bool(np.allclose(w2 / level**2, w2[:1] / level[0] ** 2, rtol=1e-9, atol=0.0))
    if shared:
        H, w2 = H * level[:, None, :], w2[:1] / level[0] ** 2
    R = _real_lag_sums(w2[:1] if shared else w2, cosines)[:, lag]  # (n_resp or 1, n+1, n+1)
    S = _lag_sums(w2[:, None, :] * H, cosines, sines)[..., lag]  # (n_resp, n_ref, r, s)
    S = S.transpose(0, 2, 3, 1).reshape(n_resp, order + 1, (order + 1) * n_ref)
    weighted = w2[:, None, :] * H
    T = np.einsum("oik,ojk->ijk", weighted.conj(), H)
    T_lags = _lag_sums(T, cosines, sines)[..., lag]  # (i, j, r, s)
    M = T_lags.transpose(2, 0, 3, 1).reshape((order + 1) * n_ref, (order + 1) * n_ref)
    if shared:
        root = _definite_factor(R[0], float(R[0, 0, 0]), _NUMERATOR_RIDGE)
        stacked = S.transpose(1, 0, 2).reshape(order + 1, -1)
        solved = scipy.linalg.solve_triangular(root, stacked, lower=True, check_finite=False)
        half = np.asarray(solved.reshape((order + 1) * n_resp, -1), dtype=np.float64)
    else:
        roots = _definite_factor(R, R[:, :1, :1], _NUMERATOR_RIDGE)
        stack = np.linalg.solve(roots, S).reshape(n_resp * (order + 1), -1)
        half = np.asarray(stack, dtype=np.float64)
    result: npt.NDArray[np.float64] = M - half.T @ half
    return 0.5 * (result + result.T), float(np.trace(M)) / M.shape[0]


def _definite_factor(
    matrix: npt.NDArray[np.float64], size: float | npt.NDArray[np.float64], relative: float
) -> npt.NDArray[np.float64]:
    """Lower Cholesky factor of one or many normal matrices under a ridge.

    The ridge is `relative` times `size`, ten times that until the matrix is definite: noise-free
    data leave nothing but rounding in some directions.
    """
    identity = np.eye(matrix.shape[-1])
    ridge = relative * size
    for _ in range(10):
        try:
            factor = np.linalg.cholesky(matrix + ridge * identity)
        except np.linalg.LinAlgError:
            ridge *= 10.0
        else:
            return factor.astype(np.float64, copy=False)
    raise EstimateError(
        "pole estimation met normal equations that are not definite; "
        "check for FRFs that are constant or repeated, or lower the order"
    )


def _companion_poles(
    coefficients: npt.NDArray[np.float64], n_ref: int
) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128]]:
    """Roots z of det(I + A_1 z + ... + A_n z^n) and the left null vectors there.

    In u = 1/z the transposed polynomial is monic, so its companion matrix gives u, and the last
    block of an eigenvector is w with w^T A(z) = 0: the participation of the references.
    """
    size = coefficients.shape[0]  # n * n_ref
    companion = np.zeros((size, size))
    companion[:n_ref] = -coefficients.T
    companion[n_ref:, :-n_ref] = np.eye(size - n_ref)
    if n_ref == 1:
        u = np.linalg.eigvals(companion)
        w = np.ones((size, 1), dtype=np.complex128)
    else:
        u, vectors = scipy.linalg.eig(companion, check_finite=False)
        w = vectors[-n_ref:].T
    usable = np.abs(u) > 1e-6
    norm = np.linalg.norm(w[usable], axis=1, keepdims=True)
    return 1.0 / u[usable], w[usable] / np.maximum(norm, np.finfo(float).tiny)


def poles_plscf(
    values: npt.NDArray[np.complex128],
    freq_hz: npt.NDArray[np.float64],
    *,
    decay_rad_s: float = 0.0,
    weight: npt.NDArray[np.float64] | None = None,
    max_order: int = 60,
    order_step: int | None = None,
) -> Stabilisation:
    """Poles over model orders.

    Parameters
    ----------
    values
        (n_resp, n_ref, n_freq), any FRF form.
    freq_hz
        (n_freq,), increasing, > 0, evenly spaced or not.
    decay_rad_s
        Real part of the lines; poles are returned with it added back.
    weight
        (n_resp, n_freq), one over the standard deviation of a line; None weights each response
        by one over its RMS.
    max_order
        Highest polynomial order; capped where there are too few lines for it.
    order_step
        Step between orders; by default some thirty orders are tried.

    Returns
    -------
    Stabilisation
        Poles with positive frequency inside the band, stable or not.

    Raises
    ------
    EstimateError
        If values are not finite, or fewer than eight lines are given.
    """
    n_resp, n_ref, n_freq = values.shape
    if n_freq < 8 or not np.all(np.isfinite(values)):
        raise EstimateError(
            f"pole estimation needs at least 8 lines of finite FRF values, got {n_freq} lines, "
            f"{np.count_nonzero(~np.isfinite(values))} values not finite; "
            "record longer or widen the band"
        )
    if weight is None:
        rms = np.sqrt(np.mean(np.abs(values) ** 2, axis=(1, 2)))
        safe = np.where(rms > 0.0, rms, 1.0)
        weight = np.broadcast_to(1.0 / safe[:, None], (n_resp, n_freq))
    order = min(max_order, n_freq - 2)
    zone = _zone(float(freq_hz[0]), float(freq_hz[-1]))
    theta = 2.0 * np.pi * freq_hz * zone.dt_s
    M, size = _normal_matrix(values, weight, theta, order)

    factor = _definite_factor(M[n_ref:, n_ref:], size, _LEAST_RIDGE)
    forward = scipy.linalg.solve_triangular(
        factor, -M[n_ref:, :n_ref], lower=True, check_finite=False
    )

    step = order_step or max(1, round(order / 40))
    orders = tuple(range(order, max(order // 4, 2) - 1, -step))[::-1]
    rows: list[tuple[int, npt.NDArray[np.complex128], npt.NDArray[np.complex128]]] = []
    for n in orders:
        rows_used = n * n_ref
        # The leading block of a Cholesky factor is the factor of the leading block.
        coefficients = scipy.linalg.solve_triangular(
            factor[:rows_used, :rows_used],
            forward[:rows_used],
            lower=True,
            trans="T",
            check_finite=False,
        )
        z, participation = _companion_poles(coefficients, n_ref)
        upper = z.imag > 1e-9 * np.abs(z)
        w = participation[upper]
        rows.append((n, zone.unfold(z[upper]) + decay_rad_s, w.conj() if zone.reversed else w))
    return Stabilisation(
        order=np.concatenate([np.full(pole.size, n, dtype=np.int64) for n, pole, _ in rows]),
        pole_rad_s=np.concatenate([pole for _, pole, _ in rows]),
        participation=np.concatenate([w for _, _, w in rows]),
        orders=orders,
    )
