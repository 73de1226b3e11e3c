"""A drive's rotor: inertia behind the transmission, held by its servo."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from pydantic import model_validator

from armodal.hil_sim.effects.compared import Compared, TrueEffect, told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Rotor"]

ROTOR = 0.15  # of the inertia that the joint carries in the first posture
SERVO = 0.4  # servo compliance / joint compliance


class Rotor(BaseEffect):
    """The rotor of a joint's drive, its inertia reflected to the joint (ratio squared times J).

    With a servo stiffness the rotor is a degree of freedom of its own: servo, rotor,
    transmission, link in a row, the transmission being the joint's own spring and damper.
    Without one the rotor turns as the joint does, the compliance lying on its motor's side.
    The rotor rides on the link before and turns about an axis parallel to the joint's.
    """

    kind: Literal["rotor"]
    joint: str
    inertia_kg_m2: NotNegative
    ratio: Positive = 100.0
    servo_stiffness_n_m_per_rad: Positive | None = None
    servo_damping_n_m_s_per_rad: NotNegative | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if (self.servo_stiffness_n_m_per_rad is None) != (self.servo_damping_n_m_s_per_rad is None):
            raise ValueError("give both servo stiffness and servo damping, or neither")
        if self.servo_stiffness_n_m_per_rad is not None and self.inertia_kg_m2 == 0.0:
            raise ValueError("a rotor on a servo needs an inertia above 0")
        return self

    def coordinates(self) -> tuple[str, ...]:
        """The rotor's turn, as seen at the joint."""
        if self.servo_stiffness_n_m_per_rad is None:
            return ()
        return (f"rotor of {self.joint}",)

    def act(self, terms: LinearTerms) -> None:
        """Add the rotor's inertia and, where it has one, its servo."""
        link = terms.index(self.joint)
        own = link
        if self.servo_stiffness_n_m_per_rad is not None:
            # The joint's spring stretches by the difference of link and rotor.
            own = terms.index(self.coordinates()[0])
            spring = terms.springs[self.joint]
            for matrix, servo, transmission in (
                (terms.K, self.servo_stiffness_n_m_per_rad, spring.k),
                (terms.C, self.servo_damping_n_m_s_per_rad or 0.0, spring.c),
            ):
                matrix[own, own] += servo + transmission
                matrix[own, link] -= transmission
                matrix[link, own] -= transmission
            terms.stretch[self.joint][own] = -1.0
        # Kinetic energy J (ratio theta' + carrier's spin)^2 / 2; the last square is the link's.
        row = np.eye(len(terms.labels))[own]
        spin = terms.spin_before(self.joint)
        terms.M = terms.M + self.inertia_kg_m2 * (
            np.outer(row, row) + (np.outer(row, spin) + np.outer(spin, row)) / self.ratio
        )


def _rotor(own: FileEffect) -> Twin:
    table = {"kind": "rotor", "joint": own.effect.place, "inertia_kg_m2": own.sizes["rotor"]}
    return Twin(tables=[table])


def _servo(own: FileEffect) -> Twin:
    spring = own.spring("servo_compliance", "servo_loss")
    table = {
        "kind": "rotor",
        "joint": own.effect.place,
        "inertia_kg_m2": own.sizes["servo_rotor"],
        "servo_stiffness_n_m_per_rad": spring["stiffness_n_m_per_rad"],
        "servo_damping_n_m_s_per_rad": spring["damping_n_m_s_per_rad"],
    }
    return Twin(tables=[table])


def _hide_rotor(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Reflected inertia that turns as the joint does."""
    joint = places.main_joint(rng)
    inertia = ROTOR * places.carried(joint) * magnitude * about(rng)
    table = {"kind": "rotor", "joint": joint, "inertia_kg_m2": inertia}
    return hidden("rotor", joint, table, inertia_kg_m2=inertia)


def _hide_servo(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A soft servo, the rotor a degree of freedom of its own."""
    joint = places.main_joint(rng)
    inertia = ROTOR * places.carried(joint) * about(rng)
    own = places.joints[joint]
    k = own["stiffness_n_m_per_rad"] / (SERVO * magnitude * about(rng))
    table = {
        "kind": "rotor",
        "joint": joint,
        "inertia_kg_m2": inertia,
        "servo_stiffness_n_m_per_rad": float(k),
        "servo_damping_n_m_s_per_rad": float(2.0 * own["damping_n_m_s_per_rad"]),
    }
    return hidden(
        "servo", joint, table, inertia_kg_m2=inertia, servo_stiffness_n_m_per_rad=float(k)
    )


def _of_servo(true: TrueEffect) -> float:
    return float(1.0 / true.parameters["servo_stiffness_n_m_per_rad"])


OF_FILE = {"rotor": _rotor, "servo": _servo}
COMPARED = {"rotor": told("inertia_kg_m2"), "servo": Compared(size=_of_servo)}
HIDES = {
    "rotor": Hides(
        hide=_hide_rotor, since=1, sized=True, apart_from=("servo",), larger_on={"bench57": 4.0}
    ),
    "servo": Hides(hide=_hide_servo, since=1, sized=True),
}
