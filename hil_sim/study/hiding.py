"""Effects put into an erring arm, each drawn from a stream of its own, and the truth about them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from armodal.hil_sim.effects.hidden import Hidden
from armodal.hil_sim.streams import stream
from armodal.hil_sim.study.arms import StudyArm, study_arm
from armodal.hil_sim.study.catalogue import HIDES, MAGNITUDES, OUTSIDE
from armodal.hil_sim.study.model_error import Tables, erring_plant_tables
from armodal.hil_sim.study.of_file import with_file_effects
from armodal.hil_sim.study.places import ArmPlaces
from armodal.hil_sim.study.prominence import Bystander
from armodal.hil_sim.study.sizing import AS_MADE, clear_place, clear_size
from armodal.protocols.errors import PlantError

__all__ = ["CaseSpec", "hide", "hide_in"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseSpec:
    """What is hidden, and how large: this is the truth, the analysis never sees it.

    `kinds` is () for a null. `ladder` has every point hit at the arm's ladder of levels.
    """

    number: int
    arm: str
    seed: int
    kinds: tuple[str, ...]
    magnitude: str | float  # "clear", "medium", "faint", or times clear; "none" for nulls
    ladder: bool = False


@lru_cache(maxsize=1024)  # a study seals all its cases first, and measures each later
def hide(spec: CaseSpec) -> tuple[Tables, dict[str, Any]]:
    """Tables of the plant with its effects, and the truth about them; to be read only."""
    return hide_in(study_arm(spec.arm), spec)


def hide_in(study: StudyArm, spec: CaseSpec) -> tuple[Tables, dict[str, Any]]:
    """Hide effects in an arm that need not be the study's own.

    Raises
    ------
    PlantError
        If an effect has no place on the arm, or its file has one that is not in `hil_sim`.
    """
    plain = with_file_effects(erring_plant_tables(study, spec.seed), study.arm, spec.seed)
    places, bystander = ArmPlaces(study, plain), Bystander(study, plain)
    tables, truths = plain, []
    for i, name in enumerate(spec.kinds):
        effect = _Effect(spec, name, spec.kinds[:i].count(name), places, bystander)
        made, stands_out = effect.sized()
        tables = _with(tables, made)
        truths.append(made.truth() | {"clear_stands_out": stands_out})
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


@dataclass(frozen=True, slots=True)
class _Effect:
    """An effect of a case; `copy` counts those of the same name before it."""

    spec: CaseSpec
    name: str
    copy: int
    places: ArmPlaces
    bystander: Bystander

    def sized(self) -> tuple[Hidden, float | None]:
        """Return what is hidden, and how far its clear size stands out where that was searched."""
        sized = AS_MADE
        if HIDES[self.name].sized:
            sized = clear_size(self._stands_out)
        elif HIDES[self.name].placed:
            sized = clear_place(self._stands_out)
        factor = self.spec.magnitude
        if isinstance(factor, str):
            factor = MAGNITUDES[factor]
        size = sized.size * HIDES[self.name].larger_on.get(self.spec.arm, 1.0)
        return self._made(sized.place, size * factor), sized.stands_out or None

    def _made(self, place: int, size: float) -> Hidden:
        make = HIDES[self.name].hide
        rng = stream(self.spec.seed, "effect", self.name, self.copy, place)
        try:
            return make(self.places, rng, size)
        except PlantError:
            raise
        except (IndexError, ValueError) as error:  # nothing to choose from
            raise PlantError(
                f"{self.name} has no place on {self.places.study.arm.name}, which has too few "
                "joints, links or points for it; hide another effect"
            ) from error

    def _stands_out(self, place: int, size: float) -> float:
        """Alone on the arm, so that what else is hidden changes nothing."""
        return self.bystander.stands_out(_with(self.places.tables, self._made(place, size)))


def _with(tables: Tables, made: Hidden) -> Tables:
    """The arm with what is hidden in the place of an error of the same kind there."""
    taken = {(table["kind"], table.get("joint", "")) for table in made.tables}
    kept = [
        table
        for table in tables["effects"]
        if (table["kind"], table.get("joint", "")) not in taken
        and not (table["kind"] == "hysteretic" and made.name == "hysteretic")
    ]
    return tables | {"effects": [*kept, *made.tables]}
