"""How large a hidden effect may be: a linear look's largest size, held against the data.

A linear look about no size at all takes an effect's first bit for the whole of it. A servo behind
a joint softens it at first and nothing else; a large one brings its rotor's own freedom with it,
which everybody would see.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from armodal.analyzer.gap.inference.fit import Fit, Stage, cost_at, fit_hypothesis
from armodal.analyzer.gap.search.rivals import STEPS
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["HiddenSize"]

_TRIALS = 4  # each of half the size


class HiddenSize:
    """How large a hidden effect may be: as a linear look says, until it is held against data.

    Then it is the least of that size's halves that the data speak against, if they do. What they
    leave room for lies below, by less than half: a range is rather too wide than too narrow.

    Parameters
    ----------
    stage, final
        Lines, and the final model fitted to them.
    linear
        Size by a linear look, at its 95 % limit.
    inflation
        Of the data's variance.
    """

    def __init__(
        self, stage: Stage, final: Fit, candidate: Candidate, linear: float, inflation: float
    ) -> None:
        self.candidate, self.linear = candidate, linear
        self._stage, self._final, self._inflation = stage, final, inflation
        self.at_most = linear
        # An ordinary error with a wider prior is in the model already.
        self.is_known = not candidate.instance.parameters

    def hold_against_data(self) -> None:
        """Hold it against the data, the smallest size first: that is the soonest fitted."""
        self.is_known = True
        if self._has_room(self.linear, steps=0):
            return
        for halves in reversed(range(_TRIALS)):
            size = self.linear / 2.0**halves
            if not self._has_room(size, steps=STEPS):
                self.at_most = size
                return

    def _has_room(self, size: float, steps: int) -> bool:
        """Whether a model with the effect at that size costs hardly more."""
        stage, final, candidate = self._stage, self._final, self.candidate
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
            name: value + candidate.follow.get(name, 0.0) * size
            for name, value in final.values.items()
        }
        enough = (
            final.cost + 0.5 * float(chdtri(1, 0.05)) * self._inflation
        )  # 95 % of one parameter's
        if cost_at(stage, hypothesis, followed) < enough:
            return True
        if steps == 0:
            return False
        try:
            fit = fit_hypothesis(
                stage,
                hypothesis,
                start=followed,
                max_iterations=steps,
                closing=False,
                enough=enough,
            )
        except np.linalg.LinAlgError:  # so large that nothing holds the arm
            return False
        return fit.cost < enough
