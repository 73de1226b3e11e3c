"""What an effect may change, and how effects of the frame are written.

A module of `effects` gives `RANGE`, the least and largest size (None: there is only one), `where`,
the places an arm has for it, and `hide`, which changes the kit and returns the truth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, LinkRow
from armodal.hil_sim.makers.frame.everyday import Everyday, Gear
from armodal.hil_sim.makers.frame.modal import loss_law
from armodal.hil_sim.makers.frame.parts import Parts
from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

__all__ = ["Hidden", "HidesInFrame", "Kit", "law_at_told", "stiffer_at_told"]

Hidden = dict[str, Any]


@dataclass(slots=True, kw_only=True)
class Kit:
    """Parts and gear to be changed, with the stream of this effect."""

    drawn: Everyday
    parts: Parts
    gear: Gear
    rng: np.random.Generator

    def row(self, name: str) -> LinkRow:
        """Return the row of a joint or a link."""
        return next(row for row in self.drawn.table.links if name in {row.joint, row.link})

    def softest(self) -> float:
        """Return the largest compliance of the first three drives, rad/(N m)."""
        return max(1.0 / self.parts.drives[joint].stiffness for joint in self.drawn.elastic[:3])

    def arm_kg(self) -> float:
        """Return the mass of all that moves."""
        return float(sum(body.mass_kg for body in self.parts.bodies))

    def anywhere(self) -> Array:
        """Draw a unit vector of any direction."""
        z, turn = self.rng.uniform(-1.0, 1.0), self.rng.uniform(0.0, 2.0 * np.pi)
        r = np.sqrt(1.0 - z * z)
        return np.array([r * np.cos(turn), r * np.sin(turn), z])


def law_at_told() -> float:
    """What a unit loss factor adds to a unit stiffness where a truth is told."""
    return float(loss_law(2.0j * np.pi * np.array([STIFFNESS_AT_HZ]))[0].real)


def stiffer_at_told(loss_factor: float) -> float:
    """By how much a part with a loss factor is stiffer than at rest, where a truth is told."""
    return 1.0 + loss_factor * law_at_told()


class HidesInFrame(Protocol):
    """A module of `effects`."""

    RANGE: tuple[float, float] | None

    def where(self, drawn: Everyday) -> list[str]:
        """Places of this arm where it can be."""

    def hide(self, kit: Kit, place: str, size: float) -> Hidden:
        """Hide it."""
