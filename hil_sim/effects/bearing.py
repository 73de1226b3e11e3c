"""A joint's bearing that gives way across its axis."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin, three
from armodal.hil_sim.effects.interface_loss import loss_of_file

__all__ = ["OF_FILE", "Bearing", "across"]


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


OF_FILE = {"bearing": _of_file}
