"""How surprising each posture is to a hypothesis that the other postures have told.

A fit to all postures has, about its end, the cost C, slope s and curvature A of parameters, and of
each posture its own part of them, C_p, g_p and H_p. Without that posture the parameters move along
the rest of the quadratic, and Laplace's integrals with and without it give the log density of its
data,

    -ln p = C_p - s'A^-1 s / 2 + (s - g_p)'(A - H_p)^-1 (s - g_p) / 2
            + ln det A / 2 - ln det(A - H_p) / 2 .

So no posture needs a fit of its own. What is known only in one, its aim and its mountings, is
integrated out likewise.

References
----------
Vehtari, Gelman and Gabry, Statistics and Computing 27 (2017) 1413: leave-one-out prediction from
one fit; here the factors that are left out are whole postures, and quadratic.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Fit, Stage

__all__ = ["left_out"]

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
    f = fit.free
    parts = stage.quadratics(fit.hypothesis, fit.space, fit.values, range(len(stage.lines)))
    slopes = [part.gradient[f] for part in parts]
    curvatures = [part.curvature[np.ix_(f, f)] for part in parts]
    A, slope = np.eye(int(f.sum())) + sum(curvatures), fit.u[f] + sum(slopes)
    whole = _log_density(A, slope)
    surprise = {}
    for name in dict.fromkeys(lines.name for lines in stage.lines):
        own = [p for p, lines in enumerate(stage.lines) if lines.name == name]
        others = _log_density(
            A - sum(curvatures[p] for p in own), slope - sum(slopes[p] for p in own)
        )
        surprise[name] = others - whole + sum(parts[p].cost for p in own)
    return surprise


def _log_density(curvature: Array, slope: Array) -> float:
    """Log of the integral of exp(-slope'x - x'curvature x / 2), up to a constant."""
    return 0.5 * float(slope @ np.linalg.solve(curvature, slope)) - 0.5 * float(
        np.linalg.slogdet(curvature)[1]
    )
