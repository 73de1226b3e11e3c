"""How large a hidden effect may be: the largest size believed, held against the data.

A linear look about no size at all takes an effect's first bit for the whole of it. A servo behind
a joint softens it at first and nothing else; a large one brings its rotor's own freedom with it,
which everybody would see. One that is only soft, its rotor beyond the lines, nobody sees: that look
tells no limit of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from armodal.analyzer.gap.inference.fit import Fit, Stage, cost_at, fit_hypothesis
from armodal.analyzer.gap.search.race import PATIENCE, STEPS
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["HiddenSize"]

_BEYOND = 0.05  # part of a size's distribution that lies beyond its limit: 95 % are told
_HELD = 1e-3  # of a size, its prior's deviation: it stays what it is asked for


class HiddenSize:
    """How large a hidden effect may be: at most a limit of its size, until held against data.

    Then it is the least of that limit's halves that the data speak against, if they do. A few steps
    of a fit decide: what only a long way leads to is not believed.

    Parameters
    ----------
    stage, final
        Lines, and the final model fitted to them.
    limit
        Of its size, at 95 %: by a linear look, or by its prior where such a look is blind.
    inflation
        Of the data's variance.
    """

    def __init__(
        self, stage: Stage, final: Fit, candidate: Candidate, limit: float, inflation: float
    ) -> None:
        self.candidate, self.limit = candidate, limit
        self._stage, self._final, self._inflation = stage, final, inflation
        self.at_most = limit
        # An ordinary error with a wider prior is in the model already.
        own = candidate.instance.parameters
        self.is_known = candidate.instance.size not in {p.name for p in own}

    def hold_against_data(self, least: float) -> None:
        """Hold it against the data: its limit first, then halves of it from a least size up.

        What leaves no room at one size leaves none at twice it. Small sizes are near to where a
        look foretells them and soon fitted, large ones that have no room are not.
        """
        self.is_known = True
        if not np.isfinite(self.limit):  # nothing tells how large it is
            return
        if self._has_room(self.limit, steps=0):
            return
        halves = max(int(np.ceil(np.log2(abs(self.limit) / least))), 1)
        sizes = (self.limit / 2.0**k for k in reversed(range(halves)))
        self.at_most = next((s for s in sizes if not self._has_room(s, STEPS)), self.at_most)

    def _has_room(self, size: float, steps: int) -> bool:
        """Whether a model with the effect at that size costs hardly more."""
        stage, final, candidate = self._stage, self._final, self.candidate
        instance = candidate.instance
        firm = replace(
            instance,
            parameters=tuple(
                replace(p, mean=size, std=_HELD * abs(size), start=size)
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
        target_cost = (
            final.cost + 0.5 * float(scipy.special.chdtri(1, _BEYOND)) * self._inflation
        )  # 95 % of one parameter's
        if cost_at(stage, hypothesis, followed) < target_cost:
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
                target_cost=target_cost,
                is_hopeless=lambda f: f.cost - PATIENCE * f.promised > target_cost,
            )
        except np.linalg.LinAlgError:  # so large that nothing holds the arm
            return False
        return fit.cost < target_cost
