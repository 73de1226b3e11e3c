"""The modal model as a regression: poles given, everything else linear.

Per FRF, on the lines s_k,

    H(s) = sum_m [ R_m / (s - p_m) + R_m* / (s - p_m*) ] + c_0 s^(d-2) + c_1 s^(d-1) + c_2 s^d

with real c and d = 0, 1, 2 for receptance, mobility, accelerance. Modes below the band give the
first two (their expansion in 1/s), modes above it the last two (their expansion in s). The three
terms also make the three forms equivalent: s R/(s - p) = R + p R/(s - p), and again for s^2.
Where that is not enough, at the edge of a band that cuts a resonance or under broad rises, further
poles belong to the background: their residues are residual terms too.

All sums over lines that a least-squares step needs are collected once in Gram matrices (`gram`),
one per FRF, of the regressors of R, of c, and of the poles' derivatives R/(s - p)^2. What follows
works on those alone: solving for R and c, the gain of a mode, the Gauss-Newton step on the poles
with R and c eliminated (variable projection), and the covariance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.forms import derivative_order
from armodal.analyzer.modal.gram import WeightedLines, gram, weighted_lines
from armodal.protocols.frf_records import FrfForm

__all__ = [
    "NO_POLES",
    "RIDGE",
    "ModalData",
    "Regression",
    "misfit",
    "modal_data",
    "regress",
    "residual_terms",
]

NO_POLES: npt.NDArray[np.complex128] = np.empty(0, dtype=np.complex128)
RIDGE = 1e-13  # relative to the scaled diagonal


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalData:
    """FRFs ready for the regression, one row an FRF."""

    form: FrfForm
    s: npt.NDArray[np.complex128]  # (n_freq,)
    values: npt.NDArray[np.complex128]  # (n_frf, n_freq)
    weight: npt.NDArray[np.float64]  # (n_frf, n_freq): 1/variance; (1, n_freq) where shared
    row_weight: npt.NDArray[np.float64]  # (n_frf,): multiplies `weight`; 0 of what is not measured
    lines: WeightedLines  # the same, as sums over lines need it, without `row_weight`
    energy: npt.NDArray[np.float64]  # (n_frf,) weighted sum of squares of each FRF
    background: npt.NDArray[np.complex128]  # (n_background,) poles that are no modes
    terms: npt.NDArray[np.complex128]  # (n_terms, n_freq) residual terms, those of these poles too

    @property
    def n_terms(self) -> int:
        """Real residual terms of an FRF."""
        return int(self.terms.shape[0])

    @property
    def variance(self) -> npt.NDArray[np.float64]:
        """Variance of every line: (n_frf, n_freq), infinite where an FRF was not measured."""
        return self.variance_on(slice(None))

    def variance_on(self, lines: npt.NDArray[np.bool_] | slice) -> npt.NDArray[np.float64]:
        """Variance on some of the lines: (n_frf, n_lines)."""
        both = self.row_weight[:, None] * self.weight[:, lines]
        whole = np.full(both.shape, np.inf)
        np.divide(1.0, both, out=whole, where=both > 0.0)
        return whole


@dataclass(frozen=True, slots=True, kw_only=True)
class Regression:
    """Least-squares solution for given poles.

    Linear parameters of an FRF are Re R_1, Im R_1, Re R_2, ..., then c_0, c_1, c_2 and those of
    the background; pole parameters are Re p_1, Im p_1, Re p_2, ...
    """

    poles: npt.NDArray[np.complex128]  # (n_modes,)
    residues: npt.NDArray[np.complex128]  # (n_frf, n_modes)
    residuals: npt.NDArray[np.float64]  # (n_frf, n_terms)
    cost: npt.NDArray[np.float64]  # (n_frf,) weighted sum of squares left
    gain: npt.NDArray[np.float64]  # (n_frf, n_modes) rise of cost without the mode
    information: npt.NDArray[np.float64]  # (n_frf, 2 n_modes, 2 n_modes), poles, projected
    score: npt.NDArray[np.float64]  # (n_frf, 2 n_modes), poles, projected
    measured: npt.NDArray[np.bool_]  # (n_frf,)

    @property
    def n_measured(self) -> int:
        """FRFs that were measured: only those count as data."""
        return int(np.count_nonzero(self.measured))


def modal_data(
    form: FrfForm,
    s: npt.NDArray[np.complex128],
    values: npt.NDArray[np.complex128],
    variance: npt.NDArray[np.float64],
    background: npt.NDArray[np.complex128] = NO_POLES,
) -> ModalData:
    """FRFs of any leading shape, flattened to rows, weighted by one over their variance.

    An FRF of infinite variance was not measured: its row weighs nothing.
    """
    flat = values.reshape(-1, s.size)
    weight = 1.0 / variance.reshape(-1, s.size)
    measured = np.any(weight > 0.0, axis=1)
    # A row without weight takes the lines' weights of another, so that all may share theirs.
    weight[~measured] = weight[np.argmax(measured)]
    row = np.exp(np.mean(np.log(weight), axis=1))
    weight = weight / row[:, None]
    row = np.where(measured, row, 0.0)
    if np.allclose(weight, weight[:1], rtol=1e-9, atol=0.0):
        weight = np.ascontiguousarray(weight[:1])
    terms = residual_terms(form, s, background).T
    energy = row * np.sum(weight * np.abs(flat) ** 2, axis=1)
    return ModalData(
        form=form,
        s=s,
        values=flat,
        weight=weight,
        row_weight=row,
        lines=weighted_lines(s, weight, weight * flat, terms),
        energy=energy,
        background=background,
        terms=terms,
    )


def residual_terms(
    form: FrfForm,
    s: npt.NDArray[np.complex128],
    background: npt.NDArray[np.complex128] = NO_POLES,
) -> npt.NDArray[np.complex128]:
    """Residual regressors on the lines: (n_freq, 3 + 2 n_background), unscaled.

    s^(d-2), s^(d-1), s^d, then of each background pole those of Re and Im of its residue.
    """
    d = derivative_order(form)
    lowest = 1.0 / (s * s) if d == 0 else 1.0 / s if d == 1 else np.ones_like(s)
    direct, mirrored = (1.0 / (s[:, None] - p) for p in (background, background.conj()))
    pairs = np.stack([direct + mirrored, 1j * (direct - mirrored)], axis=-1)
    powers = np.stack([lowest, lowest * s, lowest * s * s], axis=1)
    return np.concatenate([powers, pairs.reshape(s.size, -1)], axis=1)


def misfit(data: ModalData, fit: Regression) -> npt.NDArray[np.complex128]:
    """FRFs minus the model: (n_frf, n_freq)."""
    both = np.concatenate([fit.residues, fit.residues.conj()], axis=1)
    poles = np.concatenate([fit.poles, fit.poles.conj()])
    left = data.values - fit.residuals @ data.terms
    if fit.poles.size:
        left -= both @ (1.0 / (data.s - poles[:, None]))
    result: npt.NDArray[np.complex128] = left
    return result


def regress(
    data: ModalData, poles: npt.NDArray[np.complex128], *, pole_terms: bool = True
) -> Regression:
    """Solve for residues and residual terms, and prepare a step on the poles.

    Parameters
    ----------
    data
        The FRFs with weights.
    poles
        (n_modes,) in rad/s, positive frequency, decay of the lines not taken off.
    pole_terms
        False leaves `information` and `score` empty and saves three quarters of the work.

    Returns
    -------
    Regression
    """
    n_modes, n_frf = poles.size, data.values.shape[0]
    G, b = gram(data.lines, poles, pole_terms=pole_terms)
    p = 2 * n_modes + data.n_terms

    diagonal = np.maximum(np.einsum("oii->oi", G[:, :p, :p]), np.finfo(float).tiny)
    scale = 1.0 / np.sqrt(diagonal)
    G11 = G[:, :p, :p] * scale[:, :, None] * scale[:, None, :] + RIDGE * np.eye(p)
    inverse = np.linalg.inv(G11) * scale[:, :, None] * scale[:, None, :]
    x = np.einsum("oij,oj->oi", np.broadcast_to(inverse, (n_frf, p, p)), b[:, :p])
    row = data.row_weight
    cost = np.maximum(data.energy - row * np.einsum("oi,oi->o", b[:, :p], x), 0.0)

    modal = x[:, : 2 * n_modes].reshape(n_frf, n_modes, 2)
    index = np.arange(2 * n_modes).reshape(n_modes, 2)
    blocks = inverse[:, index[:, :, None], index[:, None, :]]  # (n_frf or 1, n_modes, 2, 2)
    gain = row[:, None] * _over_blocks(blocks, modal)
    residues = x[:, 0 : 2 * n_modes : 2] + 1j * x[:, 1 : 2 * n_modes : 2]

    information = np.zeros((n_frf, 0, 0))
    score = np.zeros((n_frf, 0))
    if pole_terms and n_modes:
        information, score = _pole_step(G, b, inverse, x, residues, p, row)
    return Regression(
        poles=poles,
        residues=residues,
        residuals=x[:, 2 * n_modes :],
        cost=cost,
        gain=gain,
        information=information,
        score=score,
        measured=row > 0.0,
    )


def _over_blocks(
    blocks: npt.NDArray[np.float64], pairs: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """x^T B^-1 x of symmetric blocks (..., 2, 2) and pairs (..., 2): (...)."""
    x, y = pairs[..., 0], pairs[..., 1]
    a, b, c = blocks[..., 0, 0], blocks[..., 0, 1], blocks[..., 1, 1]
    result: npt.NDArray[np.float64] = (c * x**2 - 2.0 * b * x * y + a * y**2) / (a * c - b * b)
    return result


def _pole_step(
    G: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    inverse: npt.NDArray[np.float64],
    x: npt.NDArray[np.float64],
    residues: npt.NDArray[np.complex128],
    p: int,
    row: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Information and score of the poles with the linear parameters projected out.

    A step (a, b) of a pole changes H by R (a + jb) / (s - p)^2: per FRF the derivative regressors
    times the 2 x 2 matrix of the complex product with R.
    """
    n_frf, n_modes = residues.shape
    G21 = G[:, p:, :p]
    schur = G[:, p:, p:] - G21 @ inverse @ G21.transpose(0, 2, 1)
    rest = b[:, p:] - np.einsum("oij,oj->oi", np.broadcast_to(G21, (n_frf, *G21.shape[1:])), x)
    rest = rest.reshape(n_frf, n_modes, 2)
    C = np.empty((n_frf, n_modes, 2, 2))
    C[..., 0, 0] = C[..., 1, 1] = residues.real
    C[..., 1, 0] = residues.imag
    C[..., 0, 1] = -residues.imag
    score = np.einsum("o,omij,omi->omj", row, C, rest).reshape(n_frf, 2 * n_modes)
    blocks = schur.reshape(-1, n_modes, 2, n_modes, 2)
    blocks = np.broadcast_to(blocks, (n_frf, n_modes, 2, n_modes, 2))
    left = np.einsum("omij,omikl->omjkl", C, blocks)
    information = np.einsum("omjkl,oklh->omjkh", left, C)
    information *= row[:, None, None, None, None]
    return information.reshape(n_frf, 2 * n_modes, 2 * n_modes), score
