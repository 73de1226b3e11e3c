"""The whole modal model to maximum likelihood: poles, shapes, participations, residual terms.

Every mode's residue matrix is one shape times one participation, R_m = phi_m l_m^T, over all
responses and references at once. On the Gram matrices of `regression`, with the residual terms c
of each FRF eliminated, a step changes FRF (o, j) by

    dR_m = l_mj dphi_om + phi_om dl_mj   and   phi_om l_mj dp_m / (s - p_m)^2.

The shapes are linear once poles and participations stand; they are eliminated response by response
(variable projection), and Gauss-Newton steps with Levenberg damping move poles and participations.
The largest participation of each mode stays fixed, since phi and l share a free factor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.gram import gram
from armodal.analyzer.modal.refine import admissible
from armodal.analyzer.modal.regression import ModalData

__all__ = ["RankOneFit", "refine_rank_one"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]
_RIDGE = 1e-13
_MOST_STEPS = 30  # accepted or not
_MOST_TURNS = 1000  # of shape and participation, to begin where FRFs were not measured
_TURNED = 1e-7  # of a unit participation, that a turn still changes at the end


@dataclass(frozen=True, slots=True, kw_only=True)
class RankOneFit:
    """Maximum-likelihood modal model, and what its covariance needs.

    Parameters theta are Re p_1, Im p_1, Re p_2, ..., then Re and Im of the participations that
    are free, mode by mode within each reference. Shapes are eliminated: with e_o the noise,
    d phi_o = shape_inverse_o e_o + shape_slope_o d theta.
    """

    poles: _Complex  # (n_modes,)
    shape: _Complex  # (n_resp, n_modes)
    participation: _Complex  # (n_ref, n_modes)
    held: npt.NDArray[np.intp]  # (n_modes,) reference whose participation is held
    residuals: _Real  # (n_resp, n_ref, n_terms), 0 of what was not measured
    cost: _Real  # (n_resp, n_ref) weighted sum of squares left
    measured: npt.NDArray[np.bool_]  # (n_resp, n_ref)
    information: _Real  # (n_resp, n_theta, n_theta)
    score: _Real  # (n_resp, n_theta)
    shape_inverse: _Real  # (n_resp, 2 n_modes, 2 n_modes), inverse information of phi_o
    shape_slope: _Real  # (n_resp, 2 n_modes, n_theta)

    @property
    def n_free(self) -> int:
        """Real parameters fitted."""
        n_resp, n_modes = self.shape.shape
        return int(
            self.residuals.shape[-1] * self.n_measured + self.score.shape[1] + 2 * n_resp * n_modes
        )

    @property
    def n_measured(self) -> int:
        """FRFs that were measured."""
        return int(np.count_nonzero(self.measured))


@dataclass(frozen=True, slots=True, kw_only=True)
class _System:
    """Normal equations of each FRF in the residues (R) and the poles' regressors (P)."""

    G: _Real  # (n_resp or 1, n_ref or 1, 4 n, 4 n), weights of the rows in it unless shared
    row: _Real  # (n_resp, n_ref), multiplies G
    b: _Real  # (n_resp, n_ref, 4 n), row weight in it
    energy: _Real  # (n_resp, n_ref) left when all residues are zero
    residual_of_b: _Real  # (n_resp, n_ref, n_terms)
    residual_of_residue: _Real  # (n_resp or 1, n_ref or 1, n_terms, 2 n)


def _system(data: ModalData, poles: _Complex, shape: tuple[int, int]) -> _System:
    """Eliminate the residual terms of every FRF, in units of the regressors themselves."""
    G, b = gram(data.lines, poles)
    n, n_terms = 2 * poles.size, data.n_terms
    keep = np.r_[0:n, n + n_terms : 2 * n + n_terms]
    inner = np.arange(n, n + n_terms)
    Gcc = G[:, inner[:, None], inner]
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("oii->oi", Gcc), np.finfo(float).tiny))
    Gcc = Gcc * scale[:, :, None] * scale[:, None, :] + _RIDGE * np.eye(n_terms)
    inverse = np.linalg.inv(Gcc) * scale[:, :, None] * scale[:, None, :]
    GcK = G[:, inner[:, None], keep]
    lifted = inverse @ GcK  # (n_frf or 1, n_terms, 4 n)
    reduced = G[:, keep[:, None], keep] - GcK.transpose(0, 2, 1) @ lifted
    bc = b[:, inner]
    c = np.einsum("oij,oj->oi", np.broadcast_to(inverse, (bc.shape[0], *inverse.shape[1:])), bc)
    bK = b[:, keep] - np.einsum(
        "oij,oi->oj", np.broadcast_to(lifted, (bc.shape[0], *lifted.shape[1:])), bc
    )
    row = data.row_weight
    outer = (1, 1) if G.shape[0] == 1 else shape
    return _System(
        G=reduced.reshape(*outer, 2 * n, 2 * n),
        row=row.reshape(shape),
        b=(row[:, None] * bK).reshape(*shape, 2 * n),
        energy=(data.energy - row * np.einsum("oi,oi->o", bc, c)).reshape(shape),
        residual_of_b=c.reshape(*shape, n_terms),
        residual_of_residue=lifted[:, :, :n].reshape(*outer, n_terms, n),
    )


def _times(factor: _Complex) -> _Real:
    """Real matrices of multiplication by `factor` (..., n): (..., 2 n, 2 n), block diagonal."""
    n = factor.shape[-1]
    out = np.zeros((*factor.shape[:-1], n, 2, n, 2))
    i = np.arange(n)
    out[..., i, 0, i, 0] = out[..., i, 1, i, 1] = factor.real
    out[..., i, 1, i, 0] = factor.imag
    out[..., i, 0, i, 1] = -factor.imag
    return out.reshape(*factor.shape[:-1], 2 * n, 2 * n)


def _pairs(values: _Complex) -> _Real:
    """(..., n) complex to (..., 2 n): real and imaginary parts interleaved."""
    return np.ascontiguousarray(values).view(np.float64)


def _complex(values: _Real) -> _Complex:
    return np.ascontiguousarray(values).view(np.complex128)


def _evaluate(
    data: ModalData, poles: _Complex, participation: _Complex, held: npt.NDArray[np.intp]
) -> RankOneFit:
    """Best shapes and residual terms for given poles and participations, and a step on those."""
    n_ref, n_modes = participation.shape
    free = _free(n_ref, held)
    shape = (data.values.shape[0] // n_ref, n_ref)
    n = 2 * n_modes
    system = _system(data, poles, shape)
    row = system.row[..., None, None]
    G = system.row[..., None, None] * system.G if system.G.shape[0] == 1 else row * system.G
    RR, RP, PP = G[..., :n, :n], G[..., :n, n:], G[..., n:, n:]
    T = _times(participation)  # (n_ref, n, n)
    TtRR = T.transpose(0, 2, 1) @ RR
    normal = (TtRR @ T).sum(axis=1)  # (n_resp, n, n)
    right = np.einsum("jab,oja->ob", T, system.b[..., :n])
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("oii->oi", normal), np.finfo(float).tiny))
    conditioned = normal * scale[:, :, None] * scale[:, None, :] + _RIDGE * np.eye(n)
    inverse = np.linalg.inv(conditioned) * scale[:, :, None] * scale[:, None, :]
    phi = _complex(np.einsum("oab,ob->oa", inverse, right))  # (n_resp, n_modes)

    residues = phi[:, None, :] * participation
    a = _pairs(residues)  # (n_resp, n_ref, n)
    Ga = np.einsum("ojab,ojb->oja", RR, a)
    cost = system.energy - 2.0 * np.einsum("oja,oja->oj", system.b[..., :n], a)
    cost = np.maximum(cost + np.einsum("oja,oja->oj", Ga, a), 0.0)
    residuals = system.residual_of_b - np.einsum("ojca,oja->ojc", system.residual_of_residue, a)
    measured = system.row > 0.0
    residuals[~measured] = 0.0

    F = _times(phi)  # (n_resp, n, n)
    C = _times(residues)  # (n_resp, n_ref, n, n)
    left_R = system.b[..., :n] - Ga
    left_P = system.b[..., n:] - np.einsum("ojba,ojb->oja", RP, a)
    n_theta = n * (1 + n_ref)
    score = np.empty((shape[0], n_theta))
    score[:, :n] = np.einsum("ojab,oja->ob", C, left_P)
    score[:, n:] = np.einsum("oab,oja->ojb", F, left_R).reshape(shape[0], -1)
    information = np.zeros((shape[0], n_theta, n_theta))
    Ct = C.transpose(0, 1, 3, 2)
    Ft = F.transpose(0, 2, 1)[:, None]
    information[:, :n, :n] = (Ct @ PP @ C).sum(axis=1)
    cross_pl = Ct @ RP.transpose(0, 1, 3, 2) @ F[:, None]  # (n_resp, n_ref, n, n)
    own_l = Ft @ RR @ F[:, None]
    X = np.empty((shape[0], n, n_theta))  # phi by theta
    X[:, :, :n] = (T.transpose(0, 2, 1) @ RP @ C).sum(axis=1)
    for j in range(n_ref):
        at = slice(n * (1 + j), n * (2 + j))
        information[:, :n, at] = cross_pl[:, j]
        information[:, at, :n] = cross_pl[:, j].transpose(0, 2, 1)
        information[:, at, at] = own_l[:, j]
        X[:, :, at] = TtRR[:, j] @ F
    X = X[:, :, free]
    slope = -inverse @ X
    information = information[:, free[:, None], free] + X.transpose(0, 2, 1) @ slope
    return RankOneFit(
        poles=poles,
        shape=phi,
        participation=participation,
        held=held,
        residuals=residuals,
        cost=cost,
        measured=measured,
        information=information,
        score=score[:, free],
        shape_inverse=inverse,
        shape_slope=slope,
    )


def _free(n_ref: int, held: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Which of the poles' parts and all participations are free."""
    free = np.ones((1 + n_ref, held.size, 2), dtype=bool)
    free[1 + held, np.arange(held.size)] = False
    return np.flatnonzero(free.reshape(-1))


def _start(residues: _Complex, weight: _Real) -> tuple[_Complex, npt.NDArray[np.intp]]:
    """Participations of residues (n_resp, n_ref, n_modes), and which reference is held.

    What was not measured has no weight (n_resp, n_ref): there shape and participation are fitted
    in turn to what was, each by least squares while the other stands.
    """
    matrices = residues.transpose(2, 0, 1)
    if np.all(weight > 0.0):
        _, _, Vh = np.linalg.svd(matrices, full_matrices=False)
        return _held(Vh[:, 0].T)
    return _held(np.stack([_in_turn(residue, weight) for residue in matrices], axis=1))


def _held(participation: _Complex) -> tuple[_Complex, npt.NDArray[np.intp]]:
    """Participations over the largest of each mode, and which that is."""
    held = np.argmax(np.abs(participation), axis=0)
    return participation / participation[held, np.arange(held.size)], held


def _in_turn(residue: _Complex, weight: _Real) -> _Complex:
    """Participation (n_ref,) of one residue matrix (n_resp, n_ref) with holes."""
    tiny = np.finfo(float).tiny
    weighted = weight * residue
    participation: _Complex = np.sqrt(np.mean(np.abs(residue) ** 2, axis=0)).astype(np.complex128)
    for _ in range(_MOST_TURNS):
        before = participation
        shape = weighted @ before.conj() / np.maximum(weight @ np.abs(before) ** 2, tiny)
        told = np.maximum(weight.T @ np.abs(shape) ** 2, tiny)
        participation = weighted.T @ shape.conj() / told
        # Neither side grows at the other's cost: shape and participation share a free factor.
        participation = participation * (np.linalg.norm(before) / np.linalg.norm(participation))
        if np.all(np.abs(participation - before) <= _TURNED * np.abs(participation)):
            break
    return participation


def refine_rank_one(
    data: ModalData,
    poles: _Complex,
    residues: _Complex,
    *,
    fixed: npt.NDArray[np.bool_] | None = None,
    tolerance: float = 1e-5,
) -> RankOneFit:
    """Least weighted sum of squares of the model with one shape and participation a mode.

    Parameters
    ----------
    data
        FRFs, rows in the order of `residues`' first two axes.
    poles
        (n_modes,) to start from, rad/s.
    residues
        (n_resp, n_ref, n_modes) to start from, in the FRFs' own form.
    fixed
        (n_modes,) poles that stay where they are; none by default.
    tolerance
        Stop when no pole moves by more than this share of its half bandwidth and no
        participation by more than this share of the mode's largest.

    Returns
    -------
    RankOneFit

    References
    ----------
    Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413. El-Kafafy, De Troyer, Peeters and
    Guillaume, Mech. Syst. Signal Process. 37 (2013) 346 (MLMM, the same likelihood).
    """
    participation, held = _start(residues, data.row_weight.reshape(residues.shape[:2]))
    current = _evaluate(data, poles, participation, held)
    if poles.size == 0 or residues.shape[1] == 1:
        return current  # one reference: the poles came refined, and nothing is shared
    n = 2 * poles.size
    free = _free(residues.shape[1], held)
    stays = np.zeros(n, dtype=bool) if fixed is None else np.repeat(fixed, 2)
    damping, total = 1e-6, float(current.cost.sum())
    for _ in range(_MOST_STEPS):
        A, g = current.information.sum(axis=0), current.score.sum(axis=0)
        scale = 1.0 / np.sqrt(np.maximum(np.diag(A), np.finfo(float).tiny))
        scale[:n][stays] = 0.0
        lhs = A * scale[:, None] * scale + damping * np.eye(g.size)
        step = np.zeros(n * (1 + residues.shape[1]))
        step[free] = np.linalg.solve(lhs, g * scale) * scale
        moved = current.poles + _complex(step[:n])
        turned = current.participation + _complex(step[n:]).reshape(participation.shape)
        share = max(
            float(np.max(np.abs(moved - current.poles) / np.abs(current.poles.real))),
            float(np.max(np.abs(turned - current.participation))),
        )
        reached = np.inf
        if admissible(moved):
            trial = _evaluate(data, moved, turned, held)
            reached = float(trial.cost.sum())
        if reached <= total * (1.0 + 1e-12):
            current, total = trial, reached
            damping = max(damping / 10.0, 1e-9)
        else:
            damping = min(max(damping * 30.0, 1e-3), 1e6)
        if share < tolerance:
            break
    turned, held = _held(current.participation)
    if np.any(held != current.held):
        current = _evaluate(data, current.poles, turned, held)
    return current
