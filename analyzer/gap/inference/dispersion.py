"""How much more the postures disagree than independent errors would let them.

Neighbouring lines, channels and points share what a model leaves, so that N of them weigh like
fewer. Where a direction a of the parameters has curvature h_p = a'H_p a and slope g_p = a'g_p in
posture p, independent errors give sum_p (g_p + h_p s)^2 / h_p a mean of P - 1 with the best common
s: what it is beyond that is the factor by which the data's variance counts more. Soft and hard hits
are of one posture: what the model's form lacks there, both lack.
"""

from __future__ import annotations

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.left_out import of_postures

__all__ = ["dispersion"]

_INFORMED = 10.0  # data curvature over the prior's, of directions that the data tell
_LEAST_SHARE = 0.02  # of a direction's curvature, for a posture to have a say


def dispersion(stage: Stage, fit: Fit) -> float:
    """Return the factor of the data's variance, mean of the directions they tell; at least 1."""
    parts = of_postures(stage, fit).values()
    curvatures = np.array([part.curvature for part in parts])
    gradients = np.array([part.gradient for part in parts])
    told, directions = np.linalg.eigh(curvatures.sum(axis=0))
    directions = directions[:, told > _INFORMED]
    h = np.einsum("ik,pij,jk->kp", directions, curvatures, directions)
    g = np.einsum("ik,pi->kp", directions, gradients)
    total = h.sum(axis=1, keepdims=True)
    residual = g - h * (g.sum(axis=1, keepdims=True) / total)
    counts = h > _LEAST_SHARE * total
    free = counts.sum(axis=1) - 1
    chi2 = np.sum(np.where(counts, residual**2 / np.where(counts, h, 1.0), 0.0), axis=1)
    if not (free > 0).any():
        return 1.0
    return max(1.0, float(np.mean(chi2[free > 0] / free[free > 0])))
