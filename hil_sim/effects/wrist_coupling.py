"""Gears of a wrist: one joint's turn works on the next one's drive."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about
from armodal.hil_sim.effects.released_joint import released
from armodal.hil_sim.linear import LinearTerms
from armodal.protocols.errors import PlantError

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "WristCoupling"]

WRIST_RATIO = 1.0
STIFF_WRIST_HZ = 600.0  # of the driven link on its spring


class WristCoupling(BaseEffect):
    """The drive of `driven` runs through the hollow shaft of `driver`, whose turn winds it.

    The spring of `driven` is stretched by its own turn plus `ratio` times the driver's. The drives
    hold, so where the driver gives way by its spring the driven link turns back by its ratio.
    """

    winds_springs: ClassVar[bool] = True
    kind: Literal["wrist_coupling"]
    driver: str
    driven: str
    ratio: float

    def act(self, terms: LinearTerms) -> None:
        """Wind the spring by both turns.

        Raises
        ------
        PlantError
            If both are one joint, or something else already stretches the driven spring.
        """
        plain = terms.row(self.driven)
        if self.driver == self.driven or not np.array_equal(terms.stretch[self.driven], plain):
            raise PlantError(
                f"effects: the spring of {self.driven!r} cannot be wound by {self.driver!r}; name "
                "two joints, and no servo or other coupling on the driven one"
            )
        row = plain + self.ratio * terms.row(self.driver)
        change = np.outer(row, row) - np.outer(plain, plain)
        spring = terms.springs[self.driven]
        terms.K = terms.K + spring.k * change
        terms.C = terms.C + spring.c * change
        terms.stretch[self.driven] = row


def _of_file(own: FileEffect) -> Twin:
    driver, driven = (joint.name for joint in own.joints)
    gears = {
        "kind": "wrist_coupling",
        "driver": driver,
        "driven": driven,
        "ratio": own.sizes["wrist_ratio"],
    }
    spring, *losses = released(driven, own)
    return Twin(tables=[spring, gears, *losses], replaces=[("released_joint", driven)])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """The last drive runs through the wrist: it turns back when the joint before it gives way.

    Its own spring is stiff, since the arm file calls it rigid.
    """
    if not places.rigid:
        raise PlantError("wrist_coupling: wanted a joint believed rigid, got none")
    driver, driven = places.elastic[-1], places.rigid[0]
    stiff = places.carried(driven) * (2.0 * np.pi * STIFF_WRIST_HZ) ** 2
    ratio = float(rng.choice([-1.0, 1.0]) * WRIST_RATIO * magnitude * about(rng))
    drive = {
        "kind": "released_joint",
        "joint": driven,
        "stiffness_n_m_per_rad": stiff,
        "damping_n_m_s_per_rad": 1e-5 * stiff,
    }
    table = {"kind": "wrist_coupling", "driver": driver, "driven": driven, "ratio": ratio}
    return Hidden(
        tables=[drive, table],
        name="wrist_coupling",
        place=[driver, driven],
        parameters={"ratio": ratio},
    )


def _as_coupling(true: TrueEffect) -> str | None:
    """Gears that couple two joints with springs are a coupling: the same terms of K."""
    return "coupling" if true.case.get("wrist") == "elastic" else None


def _ratio(true: TrueEffect) -> float:
    return float(true.parameters["ratio"])


OF_FILE = {"wrist_coupling": _of_file}
COMPARED = {"wrist_coupling": Compared(size=_ratio, named=_as_coupling)}
HIDES = {"wrist_coupling": Hides(hide=hide, since=2, sized=True)}
