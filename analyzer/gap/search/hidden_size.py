"""How large a hidden effect may be: a linear look's largest size, held against the data.

A linear look about no size at all takes an effect's first bit for the whole of it. A servo behind
a joint softens it at first and nothing else; a large one brings its rotor's own freedom with it,
which everybody would see.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["largest_hidden_size"]

_STEPS = 2
_TRIALS = 4  # each of half the size
_TOLD = 1.92  # of cost: 95 % of a single parameter's


def largest_hidden_size(
    stage: Stage, final: Fit, candidate: Candidate, size: float, inflation: float
) -> float:
    """Return the size, or the least of its halves that the data still speak against.

    What they leave room for lies below, by less than half: a range is rather too wide than too
    narrow.

    Parameters
    ----------
    stage, final
        Lines, and the final model fitted to them.
    size
        By a linear look, at its 95 % limit.
    inflation
        Of the data's variance.
    """
    if not candidate.instance.parameters:
        return size  # an ordinary error with a wider prior: it is in the model already
    for trial in range(_TRIALS):
        if _has_room(stage, final, candidate, size / 2.0**trial, inflation):
            return size / 2.0 ** max(trial - 1, 0)
    return size / 2.0 ** (_TRIALS - 1)


def _has_room(
    stage: Stage, final: Fit, candidate: Candidate, size: float, inflation: float
) -> bool:
    """Whether a model with the effect at that size costs hardly more."""
    instance = candidate.instance
    firm = replace(
        instance,
        parameters=tuple(
            replace(p, mean=size, std=1e-3 * abs(size), start=size)
            if p.name == instance.size
            else p
            for p in instance.parameters
        ),
    )
    hypothesis = replace(final.hypothesis, instances=(*final.hypothesis.instances, firm))
    followed = {
        name: value + candidate.follow.get(name, 0.0) * size for name, value in final.values.items()
    }
    try:
        fit = fit_hypothesis(
            stage,
            hypothesis,
            start=followed,
            max_iterations=_STEPS,
            closing=False,
            enough=final.cost + _TOLD * inflation,
        )
    except np.linalg.LinAlgError:  # so large that nothing holds the arm
        return False
    return fit.cost - final.cost < _TOLD * inflation
