"""What a robot description says, as it says it: nothing is judged or repaired here.

Lengths m, angles rad, masses kg. A link's frame is that of the joint that moves it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

__all__ = ["MOVING", "Inertial", "Robot", "RobotJoint", "RobotLink", "Shape"]

Array = npt.NDArray[np.float64]

MOVING = frozenset({"revolute", "continuous"})  # the joints an arm file knows


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertial:
    """Mass, centre and inertia about it, in the link's frame; possible or not."""

    mass_kg: float
    center_m: Array  # (3,)
    inertia_kg_m2: Array  # (3, 3) about the centre, link axes


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """A part of a link's surface.

    `size_m` holds a box's sides, a cylinder's or capsule's radius and length (along z, without
    the caps), a sphere's radius, and a mesh's scale, which is a pure number.
    """

    kind: str  # mesh, box, cylinder, sphere, capsule, triangles
    size_m: tuple[float, ...]
    T_link_shape: Array  # (4, 4)
    named: str = ""  # a mesh's file as the description names it
    file: Path | None = None  # that file where it was found
    vertices_m: Array | None = None  # (n, 3) of triangles
    triangles: npt.NDArray[np.int64] | None = None  # (m, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotLink:
    """A link: its inertial, and its shapes to be seen and to be run into."""

    name: str
    inertial: Inertial | None
    visual: tuple[Shape, ...] = ()
    collision: tuple[Shape, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotJoint:
    """A joint of any kind; `range_rad` is in m for a prismatic one."""

    name: str
    kind: str  # as in URDF
    parent: str
    child: str
    T_parent_joint: Array  # (4, 4) at zero
    axis: Array  # (3,) unit, joint frame
    range_rad: tuple[float, float] | None
    mimics: str | None = None  # the joint it follows


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """A tree, or what was meant as one."""

    name: str
    links: dict[str, RobotLink]
    joints: tuple[RobotJoint, ...]

    def children(self, link: str) -> tuple[RobotJoint, ...]:
        """Joints that a link carries."""
        return tuple(joint for joint in self.joints if joint.parent == link)
