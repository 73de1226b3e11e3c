"""Replicas of a session without any further effect, and what every effect would gain on them.

A replica is the model fitted, with errors drawn anew: error modes of every posture (`error_modes`)
and ordinary errors with their priors' deviations, but longer tails, within bounds of nature's. A
model is wrong in its form, which pulls an effect the same way in every posture. A session cannot
tell that from the effect itself; it tells only that B postures bring B times the variance at most,
and so much is drawn.

Every effect at every place has a few columns beside the ordinary ones. What they gain after the
ordinary parameters have followed is a product of matrices, so thousands of replicas cost as much as
one look (a score bootstrap: no replica is fitted).

References
----------
Kline and Santos, J. Econometric Methods 1 (2012) 23.
Lange, Little and Taylor, J. American Statistical Association 84 (1989) 881.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.gap.inference.error_modes import (
    Sensitivities,
    curvature_of,
    error_slopes,
    opposed,
    released,
    sensitivities,
    settled,
)
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.search.scan import small

__all__ = ["Gains", "replica_gains", "within_nature"]

Array = npt.NDArray[np.float64]

_N_REPLICAS = 2000
# Of Student's t for ordinary errors: a tolerance that somebody states is itself known to a half or
# so. Lange, Little and Taylor hold four for a fair choice where it cannot be estimated.
_FREEDOM = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """Linear gains of evidence on replicas, nats."""

    instances: tuple[Instance, ...]
    replicas: Array  # (n_instances, n_replicas)
    # Median over the effects of the variance that errors give its slope, over independent errors'.
    dispersion: float
    # Likewise of errors independent between postures; of hits apart, of what soft and hard share.
    error_ratio: float


def replica_gains(
    stage: Stage, best: Fit, added: Sequence[Instance], others: Sequence[Instance]
) -> Gains:
    """Draw replicas of a model and return what every effect gains on them.

    Parameters
    ----------
    best
        The model of best evidence: what it leaves is error.
    added
        Effects of it that the replicas do not have.
    others
        Effects it does not have.
    """
    kept = tuple(i for i in best.hypothesis.instances if all(i is not a for a in added))
    # A wider prior is in the values; what an effect does beside it stays.
    firm = tuple(replace(i, relaxes={}) for i in added)
    new = tuple(replace(small(i), relaxes={}) for i in others if i.parameters)
    wide = replace(best.hypothesis, instances=(*kept, *firm, *new))
    space = wide.space()
    values = {**{p.name: p.first for p in space.parameters}, **best.values}
    parts = sensitivities(stage, wide, space, values)
    # Exchanged axes and points have neither: nothing of them is linear.
    instances = tuple(i for i in (*added, *others) if i.parameters or i.relaxes)
    apart = {p.name for i in instances for p in i.parameters}
    relaxed = {name for i in instances for name in i.relaxes}
    moved = {n for n, f in zip(best.space.index, best.free, strict=True) if f}
    at = space.index
    fitted = np.array([at[n] for n in at if n in moved])
    free = np.array([at[n] for n in at if n not in apart and (n in moved or n in relaxed)])

    H = curvature_of(parts)
    parts = settled(parts, fitted, H[np.ix_(fitted, fitted)], _pull(best, space))
    rng = np.random.default_rng(0)
    G = _drawn(parts, fitted, rng)
    prior = within_nature(space.least[free], space.most[free], rng.random((len(free), _N_REPLICAS)))
    covariance = np.linalg.inv(H[np.ix_(free, free)] + np.eye(len(free)))
    back = covariance @ (G[free] + prior)

    names = list(at)
    row_of = {names[i]: k for k, i in enumerate(free)}
    gains, ratios, own_ratios = [], [], []
    alone = opposed(parts)  # errors of single hits, where soft and hard ones are apart
    G_alone = _drawn(alone, fitted, rng) if alone else G
    back_alone = covariance @ (G_alone[free] + prior)
    for instance in instances:
        columns = np.array([at[p.name] for p in instance.parameters], dtype=np.int64)
        B = H[np.ix_(free, columns)]
        S = H[np.ix_(columns, columns)] + np.eye(len(columns)) - B.T @ covariance @ B
        slope = G[columns] - B.T @ back
        sizes = (instance.size, *instance.sizes)
        one_sided = np.array(
            [p.low >= 0.0 and p.name in sizes for p in instance.parameters], dtype=bool
        )
        gained = _added(S, slope, one_sided) if columns.size else np.zeros(_N_REPLICAS)
        if instance.relaxes:
            # Its own columns follow too, from where they are best.
            along = covariance @ B
            C = covariance + along @ np.linalg.solve(S, along.T)
            best_point = along @ np.linalg.solve(S, slope) - back
            gains.append(gained + _relaxed(C, best_point, prior, row_of, instance, space))
            continue
        gains.append(gained)
        k = [p.name for p in instance.parameters].index(instance.size)
        ratios.append(float(np.var(slope[k]) / S[k, k]))
        slope_alone = G_alone[columns[k]] - B[:, k] @ back_alone
        own_ratios.append(float(np.var(slope_alone) / S[k, k]))
    typical = float(np.median(ratios)) if ratios else 0.0  # of a library that only relaxes
    shared = typical - float(np.median(own_ratios)) if ratios and alone else typical
    return Gains(
        instances=instances,
        replicas=np.array(gains),
        dispersion=typical,
        error_ratio=max(shared, 0.0) / len(parts),
    )


def _pull(fit: Fit, space: Space) -> Array:
    """(n,) slope of a fit's own prior along what it moved, in a wider space's order and units."""
    own = {
        p.name: u / p.std
        for p, u, free in zip(fit.space.parameters, fit.u, fit.free, strict=True)
        if free
    }
    return np.array([own[n] * space.std[i] for n, i in space.index.items() if n in own])


def _drawn(
    parts: Sequence[Sensitivities], fitted: npt.NDArray[np.int64], rng: np.random.Generator
) -> Array:
    """(n, n_replicas) slopes that errors drawn anew give."""
    drawn = np.zeros((len(parts[0].raw), _N_REPLICAS))
    for slopes in error_slopes(parts, released(parts, fitted)):
        draws = rng.standard_normal((2, slopes.shape[1], _N_REPLICAS))
        draws *= np.sqrt(0.5 * len(parts))  # as if all postures erred alike
        drawn -= slopes.real @ draws[0] + slopes.imag @ draws[1]
    return drawn


def within_nature(least: Array, most: Array, even: Array) -> Array:
    """Ordinary errors (n, n_replicas) of even draws, within the bounds (n,) that nature sets.

    No compliance is negative, and one beyond its bound is an effect, which no replica has. Where a
    fit ends is no such bound: a tolerance may be as wrong as its tails are long.
    """
    below, above = (scipy.special.stdtr(_FREEDOM, bound)[:, None] for bound in (least, most))
    return np.asarray(scipy.special.stdtrit(_FREEDOM, below + (above - below) * even))


def _added(S: Array, slope: Array, one_sided: npt.NDArray[np.bool_]) -> Array:
    """Evidence gained by own columns; a size that must not be negative stays zero."""
    step = -np.linalg.solve(S, slope)
    whole = -0.5 * np.sum(step * slope, axis=0) - 0.5 * float(np.linalg.slogdet(S)[1])
    rest = ~one_sided
    fewer = np.zeros(slope.shape[1])
    if rest.any():
        S_rest = S[np.ix_(rest, rest)]
        fewer = 0.5 * np.sum(slope[rest] * np.linalg.solve(S_rest, slope[rest]), axis=0)
        fewer = fewer - 0.5 * float(np.linalg.slogdet(S_rest)[1])
    return np.asarray(np.where((step[one_sided] >= 0.0).all(axis=0), whole, fewer))


def _relaxed(
    covariance: Array,
    best: Array,
    prior: Array,
    row_of: Mapping[str, int],
    instance: Instance,
    space: Space,
) -> Array:
    """Evidence gained when priors become wide.

    Parameters
    ----------
    covariance, best
        (k, k) and (k, n) best point of ordinary parameters with narrow priors.
    prior
        (k, n) how far from their narrow priors' means replicas begin.
    row_of
        Their rows by name.
    """
    names = [n for n in instance.relaxes if n in row_of]
    rows = [row_of[n] for n in names]
    columns = [space.index[n] for n in names]
    mean, std = space.mean[columns], space.std[columns]
    # Narrow over wide deviation; narrow mean less wide one, in narrow deviations.
    narrower = std / np.array([instance.relaxes[n].std for n in names])
    shift = (mean - np.array([instance.relaxes[n].mean for n in names])) / std
    Q, best, prior = np.linalg.inv(covariance[np.ix_(rows, rows)]), best[rows], prior[rows]
    keep = narrower[:, None] ** 2
    there = prior + shift[:, None]
    W = Q - np.eye(len(Q)) + np.diag(narrower**2)
    slope = -Q @ best - prior + keep * there
    constant = 0.5 * np.sum(best * (Q @ best) - prior**2 + keep * there**2, axis=0)
    gain = 0.5 * np.sum(slope * np.linalg.solve(W, slope), axis=0) - constant
    log_det = np.linalg.slogdet(W)[1] - 2.0 * np.sum(np.log(narrower)) - np.linalg.slogdet(Q)[1]
    return np.asarray(gain - 0.5 * log_det)
