"""A race of fits on the same lines: what cannot come beside the best is let go where it stands."""

from __future__ import annotations

from collections.abc import Mapping

from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.hypothesis import Hypothesis

__all__ = ["BESIDE", "MOST_STEPS", "PATIENCE", "STEPS", "Race"]

STEPS, MOST_STEPS = 3, 28  # of a fit until it is asked whether to go on, and in all
# A fit goes on while so many times what it still promises could bring it beside the best: within
# what tells two apart, in nats.
PATIENCE, BESIDE = 3.0, 25.0


class Race:
    """Fits on one stage: each goes on only while it may still come beside the best so far.

    `behind`: evidence beyond which a fit is of no use whatever others reach.
    """

    def __init__(self, stage: Stage, behind: float = float("inf")) -> None:
        self.stage = stage
        self._behind = behind

    def is_hopeless(self, fit: Fit) -> bool:
        """Whether several times what its quadratic promises leaves a fit behind."""
        return fit.evidence - PATIENCE * fit.promised > self._behind

    def fit(
        self,
        hypothesis: Hypothesis,
        *,
        start: Mapping[str, float] | None = None,
        resumed: Fit | None = None,
    ) -> Fit:
        """Some steps of a fit; a law's slopes may be left as they are near its end."""
        is_law = any(last.law is not None for last in hypothesis.instances[-1:])
        return self.met(
            fit_hypothesis(
                self.stage,
                hypothesis,
                start=start,
                resumed=resumed,
                max_iterations=STEPS,
                closing=not is_law,
                is_hopeless=self.is_hopeless,
            )
        )

    def further(self, fit: Fit) -> Fit:
        """Some steps more, where it has not ended on these lines."""
        if fit.converged and fit.on is not None and fit.on[0] is self.stage:
            return self.met(fit)
        return self.fit(fit.hypothesis, resumed=fit)

    def to_its_end(self, fit: Fit) -> Fit:
        """Some steps more at a time, until it ends or is hopeless."""
        for _ in range(0, MOST_STEPS, STEPS):
            further = self.further(fit)
            if further is fit or further.converged or self.is_hopeless(further):
                return further
            fit = further
        return fit

    def is_in_reach(self, base: Fit, promised: float) -> bool:
        """Whether several times what is promised about a fit would not leave it behind."""
        return base.evidence - PATIENCE * promised < self._behind

    def met(self, fit: Fit) -> Fit:
        """A fit that others are set beside from now on."""
        self._behind = min(self._behind, fit.evidence + BESIDE)
        return fit
