"""What an effect may lay hands on, and how effects are written.

A module of `effects` has `SPAN`, the least and largest size (None where there is only one),
`places(drawn)`, and `put(rig, place, size)`, which returns the truth's parameters. `OUTSIDE` marks
what a gap analysis has no name for.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, LinkRow
from armodal.hil_sim.makers.mujoco.machine import Axis, Machine
from armodal.hil_sim.makers.mujoco.ordinary import Bench, Ordinary

__all__ = ["Effect", "Parameters", "Rig"]

Parameters = dict[str, Any]


@dataclass(slots=True, kw_only=True)
class Rig:
    """A machine and its bench, to be edited, with what was drawn for them."""

    drawn: Ordinary
    machine: Machine
    bench: Bench
    rng: np.random.Generator

    @property
    def compliance(self) -> float:
        """Of the arm: mean of the first three joints', rad/(N m)."""
        springs = [self.drawn.machine.axis(name).stiffness for name in self.drawn.elastic[:3]]
        return float(np.mean(1.0 / np.array(springs)))

    def row(self, name: str) -> LinkRow:
        """Return the table's row of a joint or link."""
        return next(row for row in self.drawn.table.links if name in {row.joint, row.link})

    def drive(self, joint: str) -> Axis:
        """Return the axis of a joint's drive."""
        return self.machine.axis(joint)

    def direction(self) -> Array:
        """Draw a direction, evenly over the sphere."""
        drawn = self.rng.standard_normal(3)
        return np.asarray(drawn / np.linalg.norm(drawn))


class Effect(Protocol):
    """A module of `effects`."""

    SPAN: tuple[float, float] | None

    def places(self, drawn: Ordinary) -> list[str]:
        """Where it can be, in this arm."""

    def put(self, rig: Rig, place: str, size: float) -> Parameters:
        """Put it there, and return the truth about it."""
