"""Sealed cases: a session, the arm file its user believes in, and a truth that stays closed."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from armodal.hil_sim.plant_file import PlantFile, plant_text
from armodal.hil_sim.study.arms import StudyArm, study_arm
from armodal.hil_sim.study.catalogue import LIBRARY, MAGNITUDES, OUTSIDE
from armodal.hil_sim.study.hiding import CaseSpec, hide, hide_in
from armodal.hil_sim.study.measure import measured
from armodal.hil_sim.study.model_error import Tables, plant_of_tables
from armodal.hil_sim.study.plant_of_arm import rotations
from armodal.protocols.arm.files import ARMS_DIRECTORY
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan_records import KnownMass, Plan
from armodal.protocols.session.hdf5 import write_session
from armodal.protocols.session.records import Session

__all__ = [
    "CaseFiles",
    "SealedCase",
    "braked",
    "make_case",
    "sealed",
    "write_case",
]


class SealedCase:
    """A case as the analysis gets it: `number`, `arm`, `plan`, `truth_sha256`, `session()`."""

    def __init__(self, spec: CaseSpec, study: StudyArm | None = None) -> None:
        self._spec, self._own = spec, study
        self._study: StudyArm = study or study_arm(spec.arm)

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
            Another test of the same arm, such as the workflow asks for; its `fixed_point` is hit
            along the postures' `hit_direction`.
        levels_n
            Peak forces at each point, one a hit; None takes the case's own.
        known_mass
            A mass that the laboratory bolts on.
        brakes
            With the brakes on no servo gives way; transmissions do.
        run
            Number of the measurement, so that noise and swings are others.
        """
        spec, (tables, _) = self._spec, self._hidden
        if levels_n is None and spec.ladder:
            levels_n = self._study.ladder_n
        if known_mass is not None:
            tables = _loaded(tables, self.arm, known_mass)
        if brakes:
            tables = braked(tables)
        plant = plant_of_tables(tables)
        return measured(plant, self.arm, plan or self.plan, spec.seed, levels_n, run)

    def open_truth(self) -> str:
        """The sealed truth as JSON: only the marker of a study opens it."""
        return json.dumps(self._hidden[1], sort_keys=True)

    def plant_tables(self) -> Tables:
        """Tables of the plant file; they hold the truth."""
        return self._hidden[0]

    def plant_text(self) -> str:
        """Text of the plant file, for a laboratory in real time; it holds the truth."""
        return plant_text(PlantFile.model_validate(self._hidden[0]))

    @cached_property
    def _hidden(self) -> tuple[Tables, dict[str, Any]]:
        return hide(self._spec) if self._own is None else hide_in(self._own, self._spec)


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
    magnitude: str | float = "clear",
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
        "clear", "medium" (half), "faint" (a quarter), or a factor on clear.
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


def sealed(spec: CaseSpec, study: StudyArm | None = None) -> SealedCase:
    """Close a case of a study, or of an arm that is none of the study's.

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
    if spec.kinds and isinstance(spec.magnitude, str) and spec.magnitude not in MAGNITUDES:
        raise PlantError(
            f"no magnitude is called {spec.magnitude!r}; wanted one of "
            f"{', '.join(MAGNITUDES)}, or a factor"
        )
    return SealedCase(spec, study)


def _loaded(tables: Tables, arm: Arm, body: KnownMass) -> Tables:
    """Tables of the arm with a body on it."""
    center = rotations(arm)[body.link] @ body.center_m
    effect = {"kind": "payload", "link": body.link, "mass_kg": body.mass_kg}
    effect |= {"center_m": tuple(center.tolist())}
    return tables | {"effects": [*tables["effects"], effect]}


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


def braked(tables: Tables) -> Tables:
    """A brake holds the rotor a thousand times as stiff as its servo."""
    key = "servo_stiffness_n_m_per_rad"
    effects = [
        table | {key: 1000.0 * table[key]} if table.get(key) else table
        for table in tables["effects"]
    ]
    return tables | {"effects": effects}
