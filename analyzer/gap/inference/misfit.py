"""How far a fit is from what it was fitted to."""

from __future__ import annotations

from armodal.analyzer.gap.inference.fit import Fit, Stage

__all__ = ["misfit_per_line"]


def misfit_per_line(stage: Stage, fit: Fit) -> float:
    """chi^2 per real residual, priors included."""
    return 2.0 * fit.cost / sum(w.n for w in stage.weighings)
