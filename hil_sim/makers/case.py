"""A case as the analysis gets it, whoever made it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import KnownMass, Plan
from armodal.protocols.session.hdf5 import write_session
from armodal.protocols.session.records import Session

__all__ = ["SIZES", "Case", "CaseFiles", "CaseSpec", "Measures", "write_case"]

SIZES = ("faint", "medium", "clear")


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseSpec:
    """Who makes what: this is the truth, the analysis never sees it."""

    maker: str
    seed: int
    arm: str
    wrist: str  # "elastic" or "rigid"
    kinds: tuple[str, ...]  # () is a null
    size_class: str
    number: int = 1

    @property
    def magnitude(self) -> str:
        """Of the effect, "none" of a null."""
        return self.size_class if self.kinds else "none"


class Measures(Protocol):
    """A maker's laboratory with its arm."""

    arm: Arm
    plan: Plan
    truth: dict[str, Any]

    def measure(
        self,
        plan: Plan,
        *,
        levels_n: tuple[float, ...] | None,
        known_mass: KnownMass | None,
        brakes: bool,
        run: int,
    ) -> Session:
        """Measure a plan."""


@dataclass(frozen=True)
class Case:
    """A sealed case: `arm`, `plan`, `truth_sha256`, `session()`; `open_truth()` is the marker's."""

    spec: CaseSpec
    _made: Measures

    @property
    def number(self) -> int:
        """Of the case in its study."""
        return self.spec.number

    @property
    def arm(self) -> Arm:
        """The arm as its user believes it."""
        return self._made.arm

    @property
    def plan(self) -> Plan:
        """Postures, the last two of them for validation."""
        return self._made.plan

    @cached_property
    def truth_sha256(self) -> str:
        """Hash of the truth's text, to be printed before any verdict."""
        return hashlib.sha256(self.open_truth().encode()).hexdigest()

    def session(
        self,
        plan: Plan | None = None,
        *,
        levels_n: tuple[float, ...] | None = None,
        known_mass: KnownMass | None = None,
        brakes: bool = False,
        run: int = 0,
    ) -> Session:
        """Measure, in process, in some seconds.

        Parameters
        ----------
        plan
            Another test of the same arm; None takes the case's own.
        levels_n
            Peak forces at each point, one a hit; None takes the laboratory's.
        known_mass
            A body that the laboratory bolts on.
        brakes
            With the brakes on no servo gives way.
        run
            Number of the measurement, so that noise and swings are others.
        """
        return self._made.measure(
            plan or self.plan, levels_n=levels_n, known_mass=known_mass, brakes=brakes, run=run
        )

    def open_truth(self) -> str:
        """The sealed truth as JSON: only the marker of a study opens it."""
        spec, outside = self.spec, self._made.truth["outside"]
        verdict = "named" if spec.kinds else "nothing_detectable"
        told = {
            "maker": spec.maker,
            "number": spec.number,
            "arm": spec.arm,
            "wrist": spec.wrist,
            "seed": spec.seed,
            "magnitude": spec.magnitude,
            "verdict": "outside_library" if outside else verdict,
        }
        return json.dumps(told | self._made.truth, sort_keys=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseFiles:
    """A case on disk."""

    session: Path
    arm: Path
    truth: Path
    truth_sha256: str


def write_case(case: Case, folder: Path) -> CaseFiles:
    """Write session, arm file with its URDF, and truth, whose name ends in `.truth.json`."""
    stem = f"case-{case.number:04d}"
    files = CaseFiles(
        session=folder / f"{stem}.h5",
        arm=folder / f"{stem}.arm.toml",
        truth=folder / f"{stem}.truth.json",
        truth_sha256=case.truth_sha256,
    )
    folder.mkdir(parents=True, exist_ok=True)
    files.truth.write_text(case.open_truth(), encoding="utf-8")
    files.arm.write_text(case.arm.text, encoding="utf-8")
    if case.arm.urdf_text is not None:
        urdf = folder / f"{case.arm.name}.urdf"
        urdf.write_text(case.arm.urdf_text, encoding="utf-8")
    write_session(case.session(), files.session)
    return files
