"""How far triaxial FRFs are from rigid motion, all ordinary errors allowed for.

The data of one posture are whitened by line and by point, and compressed to a few virtual lines by
a singular value decomposition: every hypothesis about a sensor is a real linear map on channels,
so all of them depend on the lines through one Gram matrix only.

    B D = A x + sum_j n_j P_j + noise,    n_j ~ N(0, sigma_j^2)

D are the FRFs of the points (sensor axes), B undoes the fault supposed, A are the rows of rigid
motion, x the unknown motion of each line, and the patterns P_j are what ordinary errors do: a
sensor tilted or with a gain a little off, a point not quite where the file says, and the aim of
the hits of that point being off on average, which the hits' own differences tell. x is projected
out; n follows from a penalised least-squares fit (a maximum a posteriori estimate).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = [
    "OrdinaryErrors",
    "Relaxed",
    "RigidFit",
    "RigidStatistics",
    "fit_relaxed",
    "fit_rigid",
    "screen",
    "statistics",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_VIRTUAL_LINES = 32
_DISCREPANCY = 0.005  # of a point's own rms on the line: what no nuisance here describes
_RANK_TOLERANCE = 1e-3  # of the whitened rows: weaker motions count as undetermined


@dataclass(frozen=True, slots=True, kw_only=True)
class OrdinaryErrors:
    """One standard deviation of errors a good measurement has."""

    tilt_rad: float
    gain: float  # relative
    position_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidStatistics:
    """Whitened, compressed FRFs of n points.

    `lines` counts the independent lines behind the virtual ones.
    """

    data: Array  # (n, 3, n_virtual), sensor axes
    deviations: Array  # (n, n_deviations, 3, n_virtual): ordinary error of the mean, one std each
    weight: Array  # (n,): a row of the design times this is whitened
    lines: float
    lost: float  # sum of squares outside the virtual lines


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidFit:
    """Result of fitting the ordinary errors under one hypothesis.

    `normal` and `gradient` are those of the penalised problem at n = 0, patterns ordered
    (point, kind): three tilts, three gains, three displacements (sensor axes), then the hits'.
    """

    cost: float
    residual: float  # the part of the cost that is not prior
    nuisance: Array  # (n_patterns,)
    normal: Array  # (n_patterns, n_patterns), without the prior
    gradient: Array  # (n_patterns,)
    prior_std: Array  # (n_patterns,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Relaxed:
    """A fit with k further unknowns that have no prior to speak of."""

    cost: float
    residual: float
    estimate: Array  # (k,)
    std: Array  # (k,)


def statistics(
    values: ComplexArray,
    variance: Array,
    deviations: ComplexArray,
    independent_share: float,
) -> RigidStatistics:
    """Whiten and compress.

    Parameters
    ----------
    values
        (n, 3, n_lines) FRFs per point.
    variance
        (n, 3, n_lines) E|error|^2.
    deviations
        (n, n_deviations, 3, n_lines) likely errors of the mean by the aim of its hits.
    independent_share
        Independent lines per line.
    """
    own = np.mean(np.abs(values) ** 2, axis=1)
    v = variance.mean(axis=1) + _DISCREPANCY**2 * own
    log_v = np.log(np.maximum(v, np.finfo(float).tiny))
    per_line = log_v.mean(axis=0)
    per_point = (log_v - per_line).mean(axis=1)
    weight = np.exp(-0.5 * per_point)
    line_weight = np.sqrt(2.0 * independent_share) * np.exp(-0.5 * per_line)

    def real(x: ComplexArray) -> Array:
        scaled = x * line_weight
        scaled = scaled * weight.reshape(-1, *(1,) * (x.ndim - 1))
        return np.concatenate([scaled.real, scaled.imag], axis=-1)

    D, d = real(values), real(deviations)
    stacked = np.concatenate([D.reshape(-1, D.shape[-1]), d.reshape(-1, D.shape[-1])])
    _, _, right = np.linalg.svd(stacked, full_matrices=False)
    right = right[:_VIRTUAL_LINES]
    F, f = D @ right.T, d @ right.T
    return RigidStatistics(
        data=frozen_array(F, np.float64),
        deviations=frozen_array(f, np.float64),
        weight=frozen_array(weight, np.float64),
        lines=float(2.0 * independent_share * values.shape[-1]),
        lost=float((D**2).sum() - (F**2).sum()),
    )


def _split(rows: Array, weight: Array) -> tuple[Array, Array]:
    """Projector off the whitened rows (3n, 3n), and their pseudo-inverse."""
    A = (rows * weight[:, None, None]).reshape(-1, rows.shape[-1])
    norms = np.maximum(np.sqrt((A**2).sum(axis=0)), np.finfo(float).tiny)
    norms[norms < 1e-12 * norms.max()] = np.inf
    left, values, right = np.linalg.svd(A / norms, full_matrices=False)
    keep = values > _RANK_TOLERANCE * values[0]
    left, values, right = left[:, keep], values[keep], right[keep]
    inverse = (right.T / values) @ left.T / norms[:, None]
    return np.eye(A.shape[0]) - left @ left.T, inverse


def screen(stats: RigidStatistics, rows: Array, corrections: Array) -> Array:
    """Sum of squares off rigid motion with no ordinary error fitted.

    Parameters
    ----------
    rows
        (n, 3, n_unknown).
    corrections
        (n_hypotheses, n, 3, 3) maps on each point's data.

    Returns
    -------
    (n_hypotheses,) float64
    """
    K, _ = _split(rows, stats.weight)
    moved = np.einsum("hpab,pbc->hpac", corrections, stats.data)
    flat = moved.reshape(len(corrections), -1, stats.data.shape[-1])
    result: Array = np.sum(flat * (K @ flat), axis=(1, 2))
    return result


def fit_rigid(
    stats: RigidStatistics,
    rows: Array,
    turning: Array,
    correction: Array,
    errors: OrdinaryErrors,
) -> RigidFit:
    """Fit the ordinary errors of every point under one hypothesis.

    Parameters
    ----------
    rows, turning
        (n, 3, n_unknown), of `RigidDesign`, rows exchanged where the hypothesis says so.
    correction
        (n, 3, 3) what undoes the fault supposed, per point.
    """
    K, inverse = _split(rows, stats.weight)
    n, _, c = stats.data.shape
    data = np.einsum("pab,pbc->pac", correction, stats.data)
    motion = inverse @ data.reshape(3 * n, c)
    turn = np.einsum("pau,uc->pac", turning, motion) * stats.weight[:, None, None]
    axes = np.eye(3)
    # Cross products with unit vectors: pattern of tilt k is e_k x data, of displacement turn x e_k.
    tilt = np.cross(axes[None, :, :, None], data[:, None], axis=2)
    gain = axes[None, :, :, None] * data[:, None]
    shift = np.cross(turn[:, None], axes[None, :, :, None], axis=2)
    aim = np.einsum("pab,pdbc->pdac", correction, stats.deviations)
    patterns = np.concatenate([tilt, gain, shift, aim], axis=1)  # (n, kinds, 3, c)
    kinds = patterns.shape[1]
    prior = np.tile(
        np.concatenate(
            [
                np.full(3, errors.tilt_rad),
                np.full(3, errors.gain),
                np.full(3, errors.position_m),
                np.ones(kinds - 9),
            ]
        ),
        n,
    )
    rest = K @ data.reshape(3 * n, c)
    gradient = np.einsum("pkac,pac->pk", patterns, rest.reshape(n, 3, c)).ravel()
    stacked = patterns.reshape(n * kinds * 3, c)
    gram = (stacked @ stacked.T).reshape(n, kinds, 3, n, kinds, 3)
    normal = np.einsum("pkaqlb,paqb->pkql", gram, K.reshape(n, 3, n, 3), optimize=True)
    return _solve(normal.reshape(n * kinds, -1), gradient, float((rest**2).sum()), prior)


def _solve(normal: Array, gradient: Array, constant: float, prior: Array) -> RigidFit:
    nuisance = np.linalg.solve(normal + np.diag(prior**-2.0), -gradient)
    residual = constant + 2.0 * gradient @ nuisance + nuisance @ normal @ nuisance
    return RigidFit(
        cost=float(residual + ((nuisance / prior) ** 2).sum()),
        residual=float(residual),
        nuisance=frozen_array(nuisance, np.float64),
        normal=frozen_array(normal, np.float64),
        gradient=frozen_array(gradient, np.float64),
        prior_std=frozen_array(prior, np.float64),
    )


def fit_relaxed(fit: RigidFit, columns: Sequence[Array], wide_std: float) -> tuple[Relaxed, ...]:
    """Free combinations of patterns beside the ordinary errors, one set at a time.

    The ordinary errors are eliminated once (a Schur complement), so that each set costs little.

    Parameters
    ----------
    columns
        Each (n_patterns, k): one further unknown a column.
    wide_std
        Standard deviation allowed to them.
    """
    N = fit.normal
    eliminated = np.linalg.solve(N + np.diag(fit.prior_std**-2.0), N)
    left = N - N @ eliminated  # what is left of the normal equations for a further unknown
    slope = fit.gradient + N @ fit.nuisance
    result = []
    for C in columns:
        S = C.T @ left @ C + np.eye(C.shape[1]) / wide_std**2
        pull = -(C.T @ slope)
        covariance = np.linalg.inv(S)
        estimate = covariance @ pull
        nuisance = fit.nuisance - eliminated @ (C @ estimate)
        cost = fit.cost - pull @ estimate
        prior = np.sum((nuisance / fit.prior_std) ** 2) + np.sum((estimate / wide_std) ** 2)
        result.append(
            Relaxed(
                cost=float(cost),
                residual=float(cost - prior),
                estimate=frozen_array(estimate, np.float64),
                std=frozen_array(np.sqrt(np.diag(covariance)), np.float64),
            )
        )
    return tuple(result)
