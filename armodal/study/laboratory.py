"""A sealed case as a laboratory that measures whatever plan it is given."""

from __future__ import annotations

from dataclasses import dataclass

from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import Plan
from armodal.protocols.session.records import Session
from armodal.study.cases import AnyCase

__all__ = ["SimulatedLaboratory"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedLaboratory:
    """A sealed case: its plant is measured as often as is asked."""

    case: AnyCase

    @property
    def arm(self) -> Arm:
        """The arm as its user believes it."""
        return self.case.arm

    @property
    def identity(self) -> str:
        """The hash of the sealed truth."""
        return f"sealed case {self.case.truth_sha256}"

    def measure(self, plan: Plan | None, number: int) -> Session:
        """Measure by a plan of one posture, or of several alike; brakes and masses as it tells."""
        if plan is None:
            return self.case.session()
        posture = plan.postures[0]  # of one alone, or all are hit alike
        return self.case.session(
            plan,
            levels_n=posture.peaks_n or None,
            brakes=posture.brakes,
            known_mass=posture.known_mass,
            run=number - 1,
        )
