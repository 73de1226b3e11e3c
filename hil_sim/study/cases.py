"""Sealed cases: a session, the arm file its user believes in, and a truth that stays closed."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from hil_sim.study.arms import StudyArm, study_arm
from hil_sim.study.catalogue import LIBRARY, MAGNITUDES, OUTSIDE
from hil_sim.study.measure import measured
from hil_sim.study.model_error import Tables, erring_plant_tables, plant_of_tables
from hil_sim.study.places import ArmPlaces
from protocols.arm.files import ARMS_DIRECTORY
from protocols.arm.records import Arm
from protocols.errors import PlantError
from protocols.plan_records import Plan
from protocols.session.hdf5 import write_session
from protocols.session.records import Session

__all__ = ["CaseFiles", "CaseSpec", "SealedCase", "make_case", "sealed", "write_case"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseSpec:
    """What is hidden, and how large: this is the truth, the analysis never sees it.

    `kinds` is () for a null. `ladder` has every point hit at the arm's ladder of levels.
    """

    number: int
    arm: str
    seed: int
    kinds: tuple[str, ...]
    magnitude: str  # "clear", "medium", "faint"; "none" for nulls
    ladder: bool = False


class SealedCase:
    """A case as the analysis gets it: `number`, `arm`, `plan`, `truth_sha256`, `session()`."""

    def __init__(self, spec: CaseSpec) -> None:
        self._spec = spec
        self._study: StudyArm = study_arm(spec.arm)

    @property
    def number(self) -> int:
        """Of the case in its study."""
        return self._spec.number

    @property
    def arm(self) -> Arm:
        """The arm as its user believes it."""
        return self._study.arm

    @property
    def plan(self) -> Plan:
        """Postures, the last of them for validation."""
        return self._study.plan

    @property
    def truth_sha256(self) -> str:
        """Hash of the truth's text, to be printed before any verdict."""
        return hashlib.sha256(self.open_truth().encode()).hexdigest()

    def session(self) -> Session:
        """Measure, in process, in some seconds."""
        tables, _ = self._hidden
        spec = self._spec
        levels = self._study.ladder_n if spec.ladder else None
        return measured(plant_of_tables(tables), self.arm, self.plan, spec.seed, levels)

    def open_truth(self) -> str:
        """The sealed truth as JSON: only the marker of a study opens it."""
        return json.dumps(self._hidden[1], sort_keys=True)

    def plant_tables(self) -> Tables:
        """Tables of the plant file; they hold the truth."""
        return self._hidden[0]

    @cached_property
    def _hidden(self) -> tuple[Tables, dict[str, Any]]:
        return _hide(self._spec, self._study)


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseFiles:
    """A case on disk."""

    session: Path
    arm: Path
    truth: Path
    truth_sha256: str


def make_case(
    seed: int,
    arm: str,
    effect: str | tuple[str, ...] | None = None,
    magnitude: str = "clear",
    *,
    ladder: bool = False,
    number: int = 1,
) -> SealedCase:
    """Close a case.

    Parameters
    ----------
    seed
        Decides everything: model error, size and place of the effect, noise.
    arm
        "bench57", "ur5" or "rv4frl".
    effect
        Name in `LIBRARY` or `OUTSIDE`, several of them, or None for a null.
    magnitude
        "clear", "medium" (half) or "faint" (a quarter).
    ladder
        Every point is hit at the arm's ladder of levels.

    Raises
    ------
    PlantError
        If a name is unknown.
    """
    kinds = () if effect is None else (effect,) if isinstance(effect, str) else effect
    return sealed(
        CaseSpec(number=number, arm=arm, seed=seed, kinds=kinds, magnitude=magnitude, ladder=ladder)
    )


def sealed(spec: CaseSpec) -> SealedCase:
    """Close a case of a study.

    Raises
    ------
    PlantError
        If a name is unknown.
    """
    for kind in spec.kinds:
        if kind not in LIBRARY and kind not in OUTSIDE:
            raise PlantError(
                f"no effect is called {kind!r}; wanted one of {', '.join((*LIBRARY, *OUTSIDE))}"
            )
    if spec.kinds and spec.magnitude not in MAGNITUDES:
        raise PlantError(
            f"no magnitude is called {spec.magnitude!r}; wanted one of {', '.join(MAGNITUDES)}"
        )
    return SealedCase(spec)


def write_case(case: SealedCase, folder: Path) -> CaseFiles:
    """Write session, arm file and truth; the truth's name ends in `.truth.json`."""
    stem = f"case-{case.number:04d}"
    files = CaseFiles(
        session=folder / f"{stem}.h5",
        arm=folder / f"{stem}.arm.toml",
        truth=folder / f"{stem}.truth.json",
        truth_sha256=case.truth_sha256,
    )
    folder.mkdir(parents=True, exist_ok=True)
    files.truth.write_text(case.open_truth(), encoding="utf-8")
    files.arm.write_text(
        (ARMS_DIRECTORY / f"{case.arm.name}.toml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    write_session(case.session(), files.session)
    return files


def _hide(spec: CaseSpec, study: StudyArm) -> tuple[Tables, dict[str, Any]]:
    """Tables of the plant with its effects, and the truth about them."""
    rng = np.random.default_rng([spec.seed, 1])
    tables = erring_plant_tables(study, rng)
    places = ArmPlaces(study, tables)
    truths = []
    for name in spec.kinds:
        make = LIBRARY.get(name) or OUTSIDE[name]
        made = make(places, rng, MAGNITUDES[spec.magnitude])
        replaced = [(t["kind"], t["joint"]) for t in made.tables if t["kind"] == "bearing"]
        kept = [
            t
            for t in tables["effects"]
            if (t["kind"], t.get("joint")) not in replaced
            and not (t["kind"] == "hysteretic" == name)
        ]
        tables["effects"] = [*kept, *made.tables]
        truths.append(made.truth())
    verdict = "named" if truths else "nothing_detectable"
    if any(name in OUTSIDE for name in spec.kinds):
        verdict = "outside_library"
    return tables, {
        "number": spec.number,
        "arm": spec.arm,
        "seed": spec.seed,
        "magnitude": spec.magnitude,
        "ladder": spec.ladder,
        "verdict": verdict,
        "effects": truths,
        "joints": {
            link["joint"]: {
                "stiffness_n_m_per_rad": link["stiffness_n_m_per_rad"],
                "damping_n_m_s_per_rad": link["damping_n_m_s_per_rad"],
            }
            for link in tables["links"]
            if link["stiffness_n_m_per_rad"] is not None
        },
        "plant": tables,
    }
