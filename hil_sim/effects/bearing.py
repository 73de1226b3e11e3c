"""A joint's bearing that gives way across its axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.compared import told
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin, three
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, loss_s
from armodal.hil_sim.effects.interface_loss import loss_of_file

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "Bearing", "across"]

BEARING = 0.1  # of the arm's own joint compliance, both ways across


def across(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors at right angles to an axis and to each other."""
    least = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, least)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


class Bearing(BaseEffect):
    """Two hinges through the joint's origin, at right angles to its axis and to each other.

    They lie beyond the joint's own hinge, so they turn with the link. The first is along
    axis x e, e being the link's axis farthest from the joint's; the second completes the frame.
    """

    kind: Literal["bearing"]
    joint: str
    stiffness_n_m_per_rad: Annotated[tuple[float, float], Field(strict=False)]
    damping_n_m_s_per_rad: Annotated[tuple[float, float], Field(strict=False)]

    def assemble(self, assembly: Assembly) -> Assembly:
        """Cut the link from its joint by two hinges."""
        axis = assembly.joint(self.joint).body.axis
        at = self.joint
        for i, direction in enumerate(across(axis)):
            label = f"bearing {i + 1} of {self.joint}"
            spring = Spring(k=self.stiffness_n_m_per_rad[i], c=self.damping_n_m_s_per_rad[i])
            assembly = assembly.split(at, label, hinge_m=np.zeros(3), axis=direction, spring=spring)
            at = label
        return assembly


def _of_file(own: FileEffect) -> Twin:
    """Two hinges through the joint; in place of the weak ones that every joint has."""
    joint, link, told = own.joint, own.joint.link.name, own.effect.description
    if "direction_a" in told:
        sides = [three(told[f"direction_{side}"]) for side in "ab"]
    else:
        sides = list(across(np.asarray(joint.axis)))
    tables = [
        {
            "kind": "link_axis",
            "link": link,
            "name": f"bearing {side} of the file at {joint.name}",
            "direction": tuple(own.turned[link] @ direction),
            "point_m": (0.0, 0.0, 0.0),
        }
        | own.spring(f"bearing_{side}")
        for side, direction in zip("ab", sides, strict=True)
        if own.sizes[f"bearing_{side}"] > 0.0
    ]
    hinges = {
        f"bearing {side} of the file at {joint.name}": 1.0 / own.sizes[f"bearing_{side}"]
        for side in "ab"
        if own.sizes[f"bearing_{side}"] > 0.0
    }
    lossy = loss_of_file(own.sizes.get("bearing_loss_factor", 0.0), hinges)
    return Twin(tables=[*tables, *lossy], replaces=[("bearing", joint.name)])


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """A joint's bearing, alike both ways across."""
    joint = places.main_joint(rng)
    k = 1.0 / (BEARING * places.compliance * magnitude * about(rng))
    lost = loss_s(rng)
    table = {
        "kind": "bearing",
        "joint": joint,
        "stiffness_n_m_per_rad": (k, k),
        "damping_n_m_s_per_rad": (lost * k, lost * k),
    }
    return hidden("bearing", joint, table, compliance_rad_per_n_m=1.0 / k)


OF_FILE = {"bearing": _of_file}
COMPARED = {"bearing": told("compliance_rad_per_n_m")}
HIDES = {"bearing": Hides(hide=hide, since=1)}
