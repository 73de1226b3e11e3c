"""Uncertainty of fitted parameters from the scatter between mountings.

The covariance does not trust the weights of the fit. It is the clustered sandwich

    S = H⁻¹ (Σ_c g_c g_cᵀ + P) H⁻¹,   H = Jᵀ W J + P

with one cluster per mounting (posture, sensor point, hit point): hits on different mountings
share nothing, while lines and axes of one mounting share everything. Each g_c is the delete-one
score of its cluster (the jackknife form, CR3), P the priors' precision. One mounting alone (points
that do not move beside it tell nothing) shows no scatter: S is then H⁻¹, the covariance that the
weights promise for errors independent from line to line.

What few mountings determine has few degrees of freedom, and the scatter of few says little. A
combination a of the parameters gets from cluster c the share v_c = aᵀ H⁻¹ H_c H⁻¹ a of its
variance, so that

    nu = (Σ v_c)² / Σ v_c² - 1

(Satterthwaite, with the shares the weights promise; one is spent on the estimate itself, which
makes the mean of equal clusters exact). The error over sqrt(aᵀ S a) follows Student's
t with nu degrees of freedom, of which the standard deviation is sqrt(nu / (nu - 2)).

References
----------
C. B. Bell, D. F. McCaffrey, Survey Methodology 28 (2002) 169; F. E. Satterthwaite, Biometrics
Bulletin 2 (1946) 110.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.confidence import TWO_SIDED_95

__all__ = ["FEWEST_DOF", "ParameterScatter", "half_width_95", "stated_half_width_95"]

Array = npt.NDArray[np.float64]

# Below three degrees of freedom a Student t has no usable variance; what is stated then is the
# least there can be, and `identify` says so.
FEWEST_DOF = 3.0
_TELLS_NOTHING = 1e-6  # of a parameter's variance: a mounting that holds less, of all of them


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterScatter:
    """Scatter of fitted parameters; `n` parameters, clusters as in the module's head."""

    covariance: Array  # (n, n), S
    cluster_share: Array  # (n_clusters, n, n), H⁻¹ H_c H⁻¹

    @classmethod
    def of(cls, cluster_hessian: Array, cluster_score: Array, prior_std: Array) -> ParameterScatter:
        """Scatter at the minimum of a weighted fit.

        Parameters
        ----------
        cluster_hessian
            (n_clusters, n, n), Jᵀ W J of each cluster.
        cluster_score
            (n_clusters, n), Jᵀ W r of each cluster.
        prior_std
            (n,) of the parameters; infinite where there is none.
        """
        P = np.diag(1.0 / prior_std**2)
        H_inverse = np.linalg.inv(cluster_hessian.sum(axis=0) + P)
        share = H_inverse @ cluster_hessian @ H_inverse
        if _n_telling(share) < 2:
            return cls(covariance=H_inverse, cluster_share=share)
        n_clusters, n = cluster_score.shape
        # Delete-one scores: (I - H_c H⁻¹)⁻¹ g_c makes the sandwich the jackknife (CR3).
        leverage = np.eye(n) - cluster_hessian @ H_inverse
        score = np.linalg.solve(leverage, cluster_score[..., None])[..., 0]
        meat = (n_clusters - 1) / n_clusters * score.T @ score + P
        return cls(covariance=H_inverse @ meat @ H_inverse, cluster_share=share)

    @property
    def one_mounting(self) -> bool:
        """Whether no more than one mounting tells anything, so that none shows a scatter."""
        return _n_telling(self.cluster_share) < 2

    def degrees_of_freedom(self, combinations: Array | None = None) -> Array:
        """Degrees of freedom of combinations (n, m) of the parameters, or of each one, (n,)."""
        share = self.cluster_share
        if combinations is None:
            shares = np.diagonal(share, axis1=1, axis2=2)
        else:
            shares = np.einsum("im,cij,jm->cm", combinations, share, combinations)
        total = shares.sum(axis=0)
        square = (shares**2).sum(axis=0)
        equal = np.divide(total**2, square, out=np.ones_like(total), where=square > 0)
        return np.asarray(np.maximum(equal - 1.0, 1.0))

    def std(self, combinations: Array | None = None) -> Array:
        """Standard deviation of combinations (n, m) of the parameters, or of each one, (n,)."""
        if combinations is None:
            variance = np.diag(self.covariance)
        else:
            variance = np.einsum("im,ij,jm->m", combinations, self.covariance, combinations)
        return np.asarray(np.sqrt(variance) * _spread(self.degrees_of_freedom(combinations)))


def _n_telling(cluster_share: Array) -> int:
    """Count the clusters that tell of any parameter."""
    own = np.diagonal(cluster_share, axis1=1, axis2=2)
    return int(np.count_nonzero((own > _TELLS_NOTHING * own.sum(axis=0)).any(axis=1)))


def half_width_95(std: float, degrees_of_freedom: float) -> float:
    """Half the 95 % interval of an estimate whose `std` is that of a Student t."""
    quantile = scipy.special.stdtrit(degrees_of_freedom, 0.975)
    return float(std / _spread(np.float64(degrees_of_freedom)) * quantile)


class Stated(Protocol):
    """A stiffness with the deviations of its scatter and of what the model leaves open."""

    @property
    def k_std(self) -> float:
        """Return the scatter's, N m/rad."""
        ...

    @property
    def k_dof(self) -> float:
        """Return its degrees of freedom."""
        ...

    @property
    def k_std_model(self) -> float:
        """Return the model's, N m/rad."""
        ...


def stated_half_width_95(row: Stated) -> float:
    """Half the 95 % interval of a stiffness, N m/rad, scatter and model together."""
    return float(np.hypot(half_width_95(row.k_std, row.k_dof), TWO_SIDED_95 * row.k_std_model))


def _spread(dof: npt.ArrayLike) -> Array:
    nu = np.maximum(dof, FEWEST_DOF)
    return np.asarray(np.sqrt(nu / (nu - 2.0)))
