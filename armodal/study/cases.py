"""Sealed cases of every maker: the simulator at home, and those that share nothing with it."""

from __future__ import annotations

from typing import Protocol

from armodal.hil_sim import makers
from armodal.hil_sim.makers import MAKERS
from armodal.hil_sim.study import CaseSpec, sealed
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import KnownMass, Plan
from armodal.protocols.session.records import Session

__all__ = ["HOME", "AnyCase", "AnySpec", "case_of", "every_maker"]

HOME = "home"

AnySpec = CaseSpec | makers.CaseSpec


class AnyCase(Protocol):
    """A sealed case, whoever made it."""

    @property
    def arm(self) -> Arm:
        """The arm as its user believes it."""
        ...

    @property
    def plan(self) -> Plan:
        """Postures, some of them for validation."""
        ...

    @property
    def truth_sha256(self) -> str:
        """Hash of the truth's text."""
        ...

    def session(
        self,
        plan: Plan | None = None,
        *,
        levels_n: tuple[float, ...] | None = None,
        known_mass: KnownMass | None = None,
        brakes: bool = False,
        run: int = 0,
    ) -> Session:
        """Measure a plan."""
        ...

    def open_truth(self) -> str:
        """Return the truth as JSON."""
        ...


def every_maker() -> tuple[str, ...]:
    """Return the names of all makers, the simulator at home first."""
    return (HOME, *MAKERS)


def case_of(spec: AnySpec) -> AnyCase:
    """Close the case of a specification."""
    return makers.case_of(spec) if isinstance(spec, makers.CaseSpec) else sealed(spec)
