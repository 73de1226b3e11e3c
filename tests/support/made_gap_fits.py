"""Fits made up for tests of what judges them."""

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.model.space import Space


def made_fit(hypothesis, *, cost, space=None, u=(), misfit=None):
    """A fit that ended at a cost, of which no curvature is known: its evidence is its cost."""
    n = len(u)
    return Fit(
        hypothesis=hypothesis,
        space=space or Space([]),
        u=np.array(u, dtype=float),
        cost=cost,
        first_cost=cost,
        misfit=(cost,) if misfit is None else misfit,
        curvature=np.zeros((n, n)),
        slope=np.zeros(n),
        free=np.ones(n, dtype=bool),
        converged=True,
        n_iterations=1,
    )
