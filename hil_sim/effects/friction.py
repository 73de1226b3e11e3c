"""Dry friction in a joint, slipping whole or little by little."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from armodal.hil_sim.effects.compared import Compared, TrueEffect, told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.file_law import spring_of, swing_of
from armodal.hil_sim.effects.from_file import FileEffect, Twin, Unlike
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.elements import Sliders
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import Positive

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Friction"]

_ELEMENTS = 48  # of the smooth law of an arm file
_CREEPS = 1.0  # 1/s: less is none within the second that a hit rings

# A swing is the joint's, after a hit of middle level.
FRICTION = 0.14  # limit / (stiffness x swing)
SEAT = 2.0  # stiffness of the friction's seat / the joint's
MICROSLIP = 0.45
MICROSLIP_SEAT = 0.4


class Friction(BaseEffect):
    """Jenkins elements beside the joint's spring.

    One element is Coulomb friction of `limit_n_m` behind the stiffness of its seat. Several share
    stiffness and limit so that they begin to slip one after the other, the first at a small part
    of the limit: microslip, whose loss and stiffness change with the amplitude from the start.
    Limits rise by a power of their order, `rise`.
    """

    kind: Literal["friction"]
    joint: str
    limit_n_m: Positive
    stiffness_n_m_per_rad: Positive
    elements: Annotated[int, Field(ge=1, le=64)] = 1
    rise: Positive = 1.0

    def act(self, terms: LinearTerms) -> None:
        """Put the elements beside the spring."""
        n = self.elements
        shares = np.full(n, 1.0 / n)
        rising = _order(n) ** self.rise
        terms.elements.append(
            Sliders(
                row=terms.stretch_of(self.joint),
                k=self.stiffness_n_m_per_rad * shares,
                limit=self.limit_n_m * rising / rising.sum(),
            )
        )


def _order(n: int) -> npt.NDArray[np.float64]:
    """The middles of n equal parts of one."""
    return np.arange(1, 2 * n, 2) / (2.0 * n)


def _friction(own: FileEffect) -> Twin:
    """A slider behind a spring (Jenkins)."""
    swing_of(own)
    if own.sizes.get("creep", 0.0) > _CREEPS:
        raise Unlike("friction that creeps")
    table = {
        "kind": "friction",
        "joint": own.joint.name,
        "limit_n_m": own.sizes["limit"],
        "stiffness_n_m_per_rad": float(np.exp(own.sizes["ln_presliding"])) * spring_of(own),
    }
    return Twin(tables=[table])


def _microslip(own: FileEffect) -> Twin:
    """Sliders that slip one after the other up to a turn (Iwan 1966)."""
    held = own.sizes["ln_stiffer_while_held"]
    k = float(np.expm1(held)) * spring_of(own)
    turn = float(-np.expm1(-held) * np.exp(own.sizes["ln_seat_slips"])) * swing_of(own)
    rise = float(np.exp(own.sizes.get("ln_seat_spread", 0.0)))
    table = {
        "kind": "friction",
        "joint": own.joint.name,
        "limit_n_m": k * turn * float(np.mean(_order(_ELEMENTS) ** rise)),
        "stiffness_n_m_per_rad": k,
        "elements": _ELEMENTS,
        "rise": rise,
    }
    return Twin(tables=[table])


def _hide_friction(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """Coulomb friction: it sticks while the swing is small."""
    return _hidden("friction", FRICTION, SEAT, 1, places, rng, magnitude)


def _hide_microslip(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A seat that slips little by little."""
    return _hidden("microslip", MICROSLIP, MICROSLIP_SEAT, 6, places, rng, magnitude)


def _hidden(
    name: str,
    size: float,
    seat: float,
    elements: int,
    places: ArmPlaces,
    rng: np.random.Generator,
    magnitude: float,
) -> Hidden:
    joint = places.main_joint(rng)
    k = places.joints[joint]["stiffness_n_m_per_rad"]
    limit = size * k * places.swing(joint) * magnitude * about(rng)
    table = {
        "kind": "friction",
        "joint": joint,
        "limit_n_m": limit,
        "stiffness_n_m_per_rad": seat * k,
        "elements": elements,
    }
    return hidden(name, joint, table, limit_n_m=limit, stiffness_n_m_per_rad=seat * k)


def _stiffer_while_held(true: TrueEffect) -> float:
    """Return the logarithm of what a joint's stiffness falls from when its seat slips."""
    p = true.parameters
    return float(np.log1p(p["stiffness_n_m_per_rad"] / p["beside_n_m_per_rad"]))


OF_FILE = {"friction": _friction, "microslip": _microslip}
COMPARED = {"friction": told("limit_n_m"), "microslip": Compared(size=_stiffer_while_held)}
HIDES = {
    "friction": Hides(hide=_hide_friction, since=2),
    "microslip": Hides(hide=_hide_microslip, since=2),
}
