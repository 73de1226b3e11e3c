"""Sums over lines of all products of two regressors, each resonance by itself.

Where d = 1/(s - p) stands on lines s = sigma + j omega, conj(d) = -1/(s - r) with r = 2 sigma - p*,
and the product of two resonances is their difference over that of their poles,

    1/((s - r)(s - p)) = [1/(s - p) - 1/(s - r)] / (p - r) ,

so that with F(p) = sum w/(s - p), whence F(r) = -F(p)*, all weighted sums of products are

    sum w conj(d_i) d_j = -(F_j + F_i*) / (p_j + p_i* - 2 sigma) ,

a Loewner matrix (A. C. Antoulas, Approximation of Large-Scale Dynamical Systems, SIAM 2005,
section 4.5.2). Squares of d are derivatives of d by its pole, and their sums derivatives of this.
The work grows with the modes and not with their square. p and r lie on either side of the lines, so
that nothing cancels, but for resonances far narrower than a line: their products are multiplied
out, as are those of the residual terms.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

__all__ = ["WeightedLines", "gram", "weighted_lines"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]

_NARROW = 0.05  # lines from the lines to the pole; its third power is lost of sixteen digits


@dataclass(frozen=True, slots=True, kw_only=True)
class WeightedLines:
    """FRFs on lines, ready for the sums with any poles; leading dimensions are problems apart."""

    s: _Complex  # (n_lines,) of one decay
    weight: _Real  # (..., n_weights, n_lines)
    factors: _Complex  # (..., n_factors, n_lines): w; w H*; w c* of every weight and term
    residual_gram: _Real  # (..., n_weights, n_terms, n_terms) of the residual terms c
    residual_frf: _Real  # (..., n_frf, n_terms)

    def of(self, which: npt.NDArray[np.int64]) -> WeightedLines:
        """Some of the problems, one more than once if asked for."""
        return replace(
            self,
            weight=self.weight[which],
            factors=self.factors[which],
            residual_gram=self.residual_gram[which],
            residual_frf=self.residual_frf[which],
        )


def weighted_lines(
    s: _Complex, weight: _Real, weighted: _Complex, residual: _Complex
) -> WeightedLines:
    """Prepare the sums.

    Parameters
    ----------
    s
        (n_lines,).
    weight
        (..., n_weights, n_lines), one row of it for all FRFs or one for each.
    weighted
        (..., n_frf, n_lines) FRFs times their weight.
    residual
        (n_terms, n_lines) residual terms, of real coefficients.
    """
    held = weight[..., :, None, :] * residual.conj()  # (..., n_weights, n_terms, n_lines)
    flat = held.reshape(*weight.shape[:-2], -1, s.size)
    return WeightedLines(
        s=s,
        weight=weight,
        factors=np.concatenate([weight, weighted.conj(), flat], axis=-2),
        residual_gram=(held @ residual.T).real,
        residual_frf=(weighted @ residual.conj().T).real,
    )


def gram(lines: WeightedLines, poles: _Complex, *, pole_terms: bool = True) -> tuple[_Real, _Real]:
    """Sums over the lines of all products of two regressors, and of regressor and FRF.

    Regressors are those of the residues (2 n_modes), of the residual terms (n_terms) and, with
    `pole_terms`, of the poles' derivatives 1/(s - p)^2 (2 n_modes).

    Parameters
    ----------
    lines
        Problems (...).
    poles
        (..., n_modes) in rad/s.

    Returns
    -------
    G, b
        (..., n_weights, q, q) and (..., n_frf, q).
    """
    n, kinds = poles.shape[-1], 2 if pole_terms else 1
    n_weights = lines.weight.shape[-2]
    n_frf, n_terms = lines.residual_frf.shape[-2:]
    z = np.concatenate([poles, poles.conj()], axis=-1)
    d = 1.0 / (lines.s - z[..., None])  # (..., 2 n, n_lines)
    if pole_terms:
        d = np.concatenate([d, d * d], axis=-2)
    sums = lines.factors @ np.swapaxes(d, -1, -2)  # (..., n_factors, kinds 2 n)
    F, Y, X = np.split(sums, [n_weights, n_weights + n_frf], axis=-2)
    K = _products(F, z, 2.0 * lines.s[0].real, kinds)
    narrow = _narrow(lines.s, poles)
    if narrow.size:
        K = _multiplied_out(K, lines.weight, d, narrow, n, kinds)
    lead = K.shape[:-2]
    q = 2 * n * kinds + n_terms
    own = np.concatenate([np.arange(2 * n), np.arange(2 * n + n_terms, q)])
    inner = np.arange(2 * n, 2 * n + n_terms)
    G = np.empty((*lead, q, q))
    G[..., own[:, None], own] = _both_pairs(K, n, kinds)
    G[..., inner[:, None], inner] = lines.residual_gram
    across = _pairs(X.reshape(*lead, n_terms, 2 * n * kinds), n, kinds)
    G[..., inner[:, None], own] = across
    G[..., own[:, None], inner] = np.swapaxes(across, -1, -2)
    b = np.empty((*Y.shape[:-1], q))
    b[..., own] = _pairs(Y, n, kinds)
    b[..., inner] = lines.residual_frf
    return G, b


def _products(F: _Complex, z: _Complex, twice_decay: float, kinds: int) -> _Complex:
    """Sums of conj(d_i) d_j and their derivatives: (..., n_weights, kinds 2 n, alike)."""
    m = z.shape[-1]
    S = (z[..., None, :] + z.conj()[..., :, None] - twice_decay)[..., None, :, :]
    N = F[..., None, :m] + F[..., :m, None].conj()
    K = np.empty((*N.shape[:-2], kinds * m, kinds * m), dtype=np.complex128)
    plain = -N / S
    K[..., :m, :m] = plain
    if kinds > 1:
        F1 = F[..., None, m:]
        mixed = -(F1 + plain) / S
        K[..., :m, m:] = mixed
        K[..., m:, :m] = np.swapaxes(mixed, -1, -2).conj()
        K[..., m:, m:] = ((F1 + np.swapaxes(F1, -1, -2).conj()) / S + 2.0 * plain / S) / S
    return K


def _narrow(s: _Complex, poles: _Complex) -> npt.NDArray[np.intp]:
    """Numbers of poles far narrower than a line, in any problem."""
    if s.size == 1:
        return np.arange(poles.shape[-1])
    step = float(s[-1].imag - s[0].imag) / (s.size - 1)
    near = s[0].real - poles.real < _NARROW * step
    return np.flatnonzero(near.any(axis=tuple(range(near.ndim - 1))))


def _multiplied_out(
    K: _Complex, weight: _Real, d: _Complex, narrow: npt.NDArray[np.intp], n: int, kinds: int
) -> _Complex:
    """The same with the products of narrow resonances multiplied out."""
    at = np.concatenate([narrow + n * part for part in range(2 * kinds)])
    for problem in np.ndindex(weight.shape[:-2]):
        transposed = d[problem].T
        conjugate = d[problem][at].conj()
        for number, w in enumerate(weight[problem]):
            own = (conjugate * w) @ transposed
            K[(*problem, number, at)] = own
            K[(*problem, number, slice(None), at)] = own.conj()
    return K


def _both_pairs(K: _Complex, n: int, kinds: int) -> _Real:
    """Products of the real regressors of Re and Im of a coefficient and its conjugate.

    These are d + m and j (d - m), m = 1/(s - p*): (..., kinds 2 n, alike).
    """
    lead = K.shape[:-2]
    parts = K.reshape(*lead, kinds, 2, n, kinds, 2, n)
    A, B = parts[..., 0, :, :, 0, :], parts[..., 0, :, :, 1, :]
    C, D = parts[..., 1, :, :, 0, :], parts[..., 1, :, :, 1, :]
    same, cross, AC, BD = A + D, B + C, A - D, B - C
    G = np.empty((*lead, kinds, n, 2, kinds, n, 2))
    G[..., 0, :, :, 0] = (same + cross).real
    G[..., 0, :, :, 1] = (BD - AC).imag
    G[..., 1, :, :, 0] = (AC + BD).imag
    G[..., 1, :, :, 1] = (same - cross).real
    return G.reshape(*lead, 2 * n * kinds, 2 * n * kinds)


def _pairs(sums: _Complex, n: int, kinds: int) -> _Real:
    """Products with what is on the left, conjugated, of those regressors: (..., kinds 2 n)."""
    parts = sums.reshape(*sums.shape[:-1], kinds, 2, n)
    d, m = parts[..., 0, :], parts[..., 1, :]
    out = np.empty((*sums.shape[:-1], kinds, n, 2))
    out[..., 0] = (d + m).real
    out[..., 1] = (m - d).imag
    return out.reshape(*sums.shape[:-1], 2 * n * kinds)
