"""A joint believed rigid that gives way."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

from armodal.hil_sim.assembly import Assembly, Spring
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.interface_loss import loss_of_file
from armodal.hil_sim.truth import NotNegative, Positive

__all__ = ["OF_FILE", "ReleasedJoint"]


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


OF_FILE = {"released_joint": _of_file}
