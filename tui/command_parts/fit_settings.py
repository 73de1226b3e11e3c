"""What `armodal fit` is asked for beside the plan."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfEstimator
from armodal.protocols.plan_records import Averaging, Windows
from armodal.protocols.session.records import Session

__all__ = ["FitSettings"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FitSettings:
    """What is asked for beside, or instead of, what the plan says; None leaves it to the plan."""

    band_hz: tuple[float, float] | None = None
    estimator: FrfEstimator | None = None
    exponential_end: float | None = None
    force_s: float | None = None
    keep_hits: int | None = None
    max_order: int = 60

    def __post_init__(self) -> None:
        """Raise `EstimateError` for windows that cannot be, also where there are no hits."""
        end, force_s = self.exponential_end, self.force_s
        if end is not None and not 0.0 < end <= 1.0:
            raise EstimateError(
                f"exponential window: wanted an end value in (0, 1], got {end}; 1 is none"
            )
        if force_s is not None and not 0.0 < force_s < np.inf:
            raise EstimateError(f"force window: wanted a length above 0 s, got {force_s}")

    def applied_to(self, session: Session) -> Session:
        """Return the session as if its plan had asked for these windows and averages."""
        plan = session.header.plan
        windows, averaging = plan.windows, plan.averaging
        end, force_s, keep = self.exponential_end, self.force_s, self.keep_hits
        windows = Windows(
            exponential_end=windows.exponential_end if end is None else end,
            force_s=windows.force_s if force_s is None else force_s,
        )
        averaging = Averaging(
            estimator=self.estimator or averaging.estimator,
            keep_hits=averaging.keep_hits if keep is None else keep,
        )
        plan = replace(plan, windows=windows, averaging=averaging)
        return replace(session, header=replace(session.header, plan=plan))

    def about_hits(self) -> bool:
        """Whether anything is asked for that only single hits can follow."""
        asked = (self.estimator, self.exponential_end, self.force_s, self.keep_hits)
        return any(value is not None for value in asked)
