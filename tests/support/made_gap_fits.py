"""Fits made up for tests of what judges them."""

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.model.effect import EffectWords
from armodal.analyzer.gap.model.space import Space


def made_words(name, *, title=""):
    """Words of an effect that is in no library."""
    return EffectWords(name=name, title=title, changes="", signature="")


def made_fit(hypothesis, *, cost, space=None, u=(), misfit=None, resting=()):
    """A fit that ended at a cost, of which no curvature is known: its evidence is its cost.

    Of what rests at a bound of its own no interval takes anything off.
    """
    n = len(u)
    space = space or Space([])
    return Fit(
        hypothesis=hypothesis,
        space=space,
        u=np.array(u, dtype=float),
        cost=cost,
        misfit=(cost,) if misfit is None else misfit,
        curvature=np.zeros((n, n)),
        slope=np.zeros(n),
        free=np.array([name not in resting for name in space.index], dtype=bool)[:n],
        converged=True,
        n_iterations=1,
    )
