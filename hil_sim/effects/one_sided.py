"""A crack or a bolt that opens one way: outside the library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from pydantic import model_validator

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, loss_s, plain, unit
from armodal.hil_sim.elements import OneSided
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.truth import NotNegative, Positive, Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["HIDES", "OneSidedCrack"]

CRACK = 0.8  # open, of the arm's joint compliance


class OneSidedCrack(BaseEffect):
    """A hinge in a link that is softer beyond an angle to one side.

    Closed, the torque is k_closed phi; beyond `opening_rad` its slope is k_open.
    """

    kind: Literal["one_sided"]
    link: str
    point_m: Vector
    direction: Vector
    stiffness_closed_n_m_per_rad: Positive
    stiffness_open_n_m_per_rad: Positive
    damping_n_m_s_per_rad: NotNegative
    opening_rad: NotNegative

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        if np.linalg.norm(self.direction) == 0.0:
            raise ValueError("direction must not be zero")
        return self

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link, closed."""
        return assembly.split(
            assembly.carrier_of(self.link).label,
            f"crack in {self.link}",
            hinge_m=np.array(self.point_m),
            axis=np.array(self.direction),
            spring=Spring(k=self.stiffness_closed_n_m_per_rad, c=self.damping_n_m_s_per_rad),
        )

    def act(self, terms: LinearTerms) -> None:
        """Let it open."""
        terms.elements.append(
            OneSided(
                row=terms.row(f"crack in {self.link}"),
                lost=self.stiffness_closed_n_m_per_rad - self.stiffness_open_n_m_per_rad,
                opening=self.opening_rad,
            )
        )


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A crack or a bolt that opens a little beside rest."""
    link = str(rng.choice(places.structural()[:4]))
    opened = 1.0 / (CRACK * places.compliance * magnitude * about(rng))
    table = {
        "kind": "one_sided",
        "link": link,
        "point_m": plain(places.somewhere(rng, link)),
        "direction": plain(unit(rng)),
        "stiffness_closed_n_m_per_rad": 8.0 * opened,
        "stiffness_open_n_m_per_rad": opened,
        "damping_n_m_s_per_rad": loss_s(rng) * opened,
        "opening_rad": float(rng.uniform(0.0, 3e-6)),
    }
    return hidden("one_sided", link, table, stiffness_open_n_m_per_rad=opened)


HIDES = {"one_sided": Hides(hide=hide, since=0)}
