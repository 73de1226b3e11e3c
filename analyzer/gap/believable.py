"""How large a hidden effect may be: a linear look's largest size, held against the data.

A linear look about no size at all takes an effect's first bit for the whole of it. A servo behind
a joint softens it at first and nothing else; a large one brings its rotor's own freedom with it,
which everybody would see.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.scan import Candidate

__all__ = ["believable"]

_STEPS = 2
_LESS, _TRIALS = 0.5, 4  # of the size, where one is too large
_TOLD = 1.92  # of cost: 95 % of a single parameter's


def believable(
    stage: Stage, final: Fit, candidate: Candidate, size: float, inflation: float
) -> float:
    """Return the size, or the part of it that the data leave room for.

    Parameters
    ----------
    stage, final
        Lines, and the final model fitted to them.
    size
        By a linear look, at its 95 % limit.
    inflation
        Of the data's variance.
    """
    instance = candidate.instance
    if not instance.parameters:
        return size  # an ordinary error with a wider prior: it is in the model already
    for _ in range(_TRIALS):
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
            name: value + candidate.follow.get(name, 0.0) * size
            for name, value in final.values.items()
        }
        try:
            fit = fit_hypothesis(
                stage, hypothesis, start=followed, max_iterations=_STEPS, closing=False
            )
        except np.linalg.LinAlgError:  # so large that nothing holds the arm
            size *= _LESS
            continue
        if fit.cost - final.cost < _TOLD * inflation:
            return size
        size *= _LESS
    return size
