"""How far a fit is from what it was fitted to, and how far replicas of it would be.

Replicas have the measured scatter and errors of a right model. How large those may be is assumed;
how unevenly they spread over lines, channels and postures is the session's own: each error mode of
a posture (`error_modes.py`) has a random amplitude, and few modes make an uncertain sum.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Fit, Stage

__all__ = ["misfit_of_replicas", "misfit_per_line"]

Array = npt.NDArray[np.float64]

# Of the assumed discrepancy's variance, what a right model leaves on average at most. Right models
# of three makers leave 0.05 to 0.3 (docs/decisions/0026): twice that is believed of a real arm.
_BELIEVED = 0.6
_N_REPLICAS = 2000


def misfit_per_line(stage: Stage, fit: Fit) -> float:
    """chi^2 per real residual, priors included."""
    return 2.0 * fit.cost / sum(w.n for w in stage.weighings)


def misfit_of_replicas(stage: Stage, fit: Fit, beyond: float) -> float:
    """chi^2 per real residual that replicas of a fit leave, but for a part `beyond` of them."""
    left: dict[str, list[npt.NDArray[Any]]] = {}
    expected: dict[str, float] = {}
    for rows, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y = together.response(fit.hypothesis, fit.values).values
        for p, i in rows:
            lines, weighing = stage.lines[p], stage.weighings[p]
            residual = weighing.cleaned(y[i])
            left.setdefault(lines.name, []).append(residual.reshape(-1, residual.shape[-1]))
            noise = lines.variance * weighing.scale**2 / 2.0
            right = noise + _BELIEVED * (1.0 - noise)
            expected[lines.name] = expected.get(lines.name, 0.0) + 2.0 * float(right.sum())
    rng = np.random.default_rng(0)
    chi2: Array = np.zeros(_N_REPLICAS)
    for name, parts in left.items():
        power = np.linalg.svd(np.concatenate(parts), compute_uv=False) ** 2
        drawn = rng.standard_exponential((_N_REPLICAS, power.size))
        chi2 += expected[name] * (drawn @ (power / power.sum()))
    return float(np.quantile(chi2, 1.0 - beyond)) / sum(w.n for w in stage.weighings)
