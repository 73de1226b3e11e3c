"""Everything an arm of beams is made of, before it stands in a posture; effects edit it."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from armodal.hil_sim.makers.arm_table import ArmTable, Array, Inertial
from armodal.hil_sim.makers.frame.beams import Section
from armodal.hil_sim.makers.frame.structure import Law

__all__ = ["Drive", "Hinge", "Parts"]


@dataclass(slots=True, kw_only=True)
class Drive:
    """A joint's six-way spring; the drive turns about the joint's axis."""

    stiffness: float  # N m/rad
    law: Law  # beyond it
    tilt: tuple[float, float]  # N m/rad about both axes across
    shift_n_per_m: float
    tilt_loss: float  # loss factor
    rotor_kg_m2: float = 0.0
    own_law: Law | None = None  # of the joint's own drive, where an effect has given it another
    braked_law: Law | None = None  # with brakes on, where they change it


@dataclass(slots=True, kw_only=True)
class Hinge:
    """A soft axis inside a link, at a part of its shell's line."""

    part: float
    direction: Array  # (3,) link frame
    point_m: Array  # (3,) link frame
    compliance: float
    loss: float


@dataclass(slots=True, kw_only=True)
class Parts:
    """An arm of beams."""

    table: ArmTable
    bodies: list[Inertial]  # of the moving links
    sections: dict[str, Section]  # by link, and of the base
    beam_loss: float
    drives: dict[str, Drive]
    plate: Array  # (6, 6) stiffness of what the base stands on
    plate_loss: float
    hinges: dict[str, Hinge] = field(default_factory=dict)
    added: list[tuple[str, Inertial]] = field(default_factory=list)  # rigid bodies on links
    offsets_rad: dict[str, float] = field(default_factory=dict)
    position_m: dict[str, Array] = field(default_factory=dict)  # of points, link frame
    braked: bool = False  # servos hold as brakes do
    last: list[Callable[[Any], None]] = field(default_factory=list)  # get the `Standing` arm

    def copy(self) -> Parts:
        """Return parts of one's own; laws and spans are shared."""
        other = copy.copy(self)
        other.bodies, other.sections = list(self.bodies), dict(self.sections)
        other.drives = {name: copy.copy(drive) for name, drive in self.drives.items()}
        other.hinges, other.added = dict(self.hinges), list(self.added)
        other.offsets_rad, other.position_m = dict(self.offsets_rad), dict(self.position_m)
        other.last = list(self.last)
        return other
