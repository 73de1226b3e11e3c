"""A joint believed rigid that gives way."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.effects.interface_loss import loss_of_file
from armodal.hil_sim.truth import NotNegative, Positive
from armodal.protocols.errors import PlantError

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "ReleasedJoint"]

RELEASED = 7.5  # of the arm's own joint compliance


class ReleasedJoint(BaseEffect):
    """The drive of a joint holds it by a spring and a damper."""

    kind: Literal["released_joint"]
    joint: str
    stiffness_n_m_per_rad: Positive
    damping_n_m_s_per_rad: NotNegative

    def assemble(self, assembly: Assembly) -> Assembly:
        """Give the joint's hinge a spring."""
        spring = Spring(k=self.stiffness_n_m_per_rad, c=self.damping_n_m_s_per_rad)
        return assembly.replaced(replace(assembly.joint(self.joint), spring=spring))


def released(joint: str, own: FileEffect) -> list[dict[str, Any]]:
    """Tables of a joint with the compliance of an effect of the file, and what it loses."""
    spring = own.spring("compliance_of")
    losses = loss_of_file(
        own.sizes.get("bearing_loss_factor", 0.0), {joint: spring["stiffness_n_m_per_rad"]}
    )
    return [{"kind": "released_joint", "joint": joint} | spring, *losses]


def _of_file(own: FileEffect) -> Twin:
    place = own.effect.place
    return Twin(tables=released(place, own), replaces=[("released_joint", place)])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A joint the arm file calls rigid."""
    if not places.rigid:
        raise PlantError("released_joint: wanted a joint believed rigid, got none")
    joint = places.rigid[0] if len(places.rigid) > 1 else places.rigid[-1]
    k = 1.0 / (RELEASED * places.compliance * magnitude * about(rng))
    table = {
        "kind": "released_joint",
        "joint": joint,
        "stiffness_n_m_per_rad": k,
        "damping_n_m_s_per_rad": 0.06 * k / (2.0 * np.pi * 100.0),
    }
    return hidden("released_joint", joint, table, stiffness_n_m_per_rad=k)


def _compliance(true: TrueEffect) -> float:
    return float(1.0 / true.parameters["stiffness_n_m_per_rad"])


OF_FILE = {"released_joint": _of_file}
COMPARED = {"released_joint": Compared(size=_compliance)}
HIDES = {"released_joint": Hides(hide=hide, since=1, sized=True)}
