"""How surprising each posture is to a hypothesis that the other postures have told.

A fit to all postures has, about its end, the cost C, slope s and curvature A of parameters, and of
each posture its own part of them, C_p, g_p and H_p. Without that posture the parameters move along
the rest of the quadratic, and Laplace's integrals with and without it give the log density of its
data,

    -ln p = C_p - s'A^-1 s / 2 + (s - g_p)'(A - H_p)^-1 (s - g_p) / 2
            + ln det A / 2 - ln det(A - H_p) / 2 .

So no posture needs a fit of its own. What is known only in one, its aim and its mountings, is
integrated out likewise. From none of the others, but from the priors alone, with u the end in prior
deviations, it is

    -ln p = C_p + u'u / 2 - (u + g_p)'(I + H_p)^-1 (u + g_p) / 2 + ln det(I + H_p) / 2 .

References
----------
Vehtari, Gelman and Gabry, Statistics and Computing 27 (2017) 1413: leave-one-out prediction from
one fit; here the factors that are left out are whole postures, and quadratic.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.weigh import Quadratic

__all__ = ["foretold_by_priors", "left_out", "of_postures"]

Array = npt.NDArray[np.float64]


def left_out(stage: Stage, fit: Fit) -> dict[str, float]:
    """Return minus the log density of each posture's data, foretold from the other postures.

    Parameters
    ----------
    stage
        Lines of all postures; soft and hard hits of one are left out together.
    fit
        To all of them, at its end.

    Returns
    -------
        Nats by the posture's name, up to a constant that no hypothesis changes.
    """
    parts = of_postures(stage, fit)
    A = np.eye(int(fit.free.sum())) + sum(part.curvature for part in parts.values())
    slope = fit.u[fit.free] + sum(part.gradient for part in parts.values())
    whole = _log_density(A, slope)
    return {
        name: part.cost + _log_density(A - part.curvature, slope - part.gradient) - whole
        for name, part in parts.items()
    }


def foretold_by_priors(stage: Stage, fit: Fit) -> dict[str, float]:
    """Return minus the log density of each posture's data, foretold from none of the others.

    What is believed before any measurement tells it; arguments and returns as of `left_out`.
    """
    u = fit.u[fit.free]
    believed = 0.5 * float(fit.u @ fit.u)
    return {
        name: part.cost
        + believed
        - _log_density(np.eye(len(u)) + part.curvature, u + part.gradient)
        for name, part in of_postures(stage, fit).items()
    }


def of_postures(stage: Stage, fit: Fit) -> dict[str, Quadratic]:
    """Each posture's part of the quadratic about a fit's end, of its free parameters."""
    f = fit.free
    parts = stage.quadratics(fit.hypothesis, fit.space, fit.values, range(len(stage.lines)))
    found: dict[str, Quadratic] = {}
    for lines, part in zip(stage.lines, parts, strict=True):
        before = found.get(lines.name)
        gradient, curvature = part.gradient[f], part.curvature[np.ix_(f, f)]
        found[lines.name] = Quadratic(
            cost=part.cost + (before.cost if before else 0.0),
            gradient=gradient + (before.gradient if before else 0.0),
            curvature=curvature + (before.curvature if before else 0.0),
        )
    return found


def _log_density(curvature: Array, slope: Array) -> float:
    """Log of the integral of exp(-slope'x - x'curvature x / 2), up to a constant."""
    return 0.5 * float(slope @ np.linalg.solve(curvature, slope)) - 0.5 * float(
        np.linalg.slogdet(curvature)[1]
    )
