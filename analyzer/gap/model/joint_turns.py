"""A joint's turn in solved postures, its derivatives by every parameter, and a torque along it.

The turn is taken for a channel of every mounting, so that what is known of recorded channels
holds for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.derivatives import Solved
from armodal.analyzer.gap.model.line_arrays import real_times, recorded
from armodal.analyzer.gap.model.response import Response
from armodal.analyzer.gap.model.system import System
from armodal.analyzer.gap.model.systems import MotionSlopes, Slopes, systems

__all__ = ["SolvedTurns", "holding_back", "turned_systems"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def turned_systems(assemblies: Sequence[Assembly], rows: Array, m: int) -> System:
    """Return postures' equations with a stretch along rows (P, N) as what m mountings record.

    On the first of three channels; the accelerometer is left out.
    """
    whole = systems(assemblies)
    P = len(assemblies)
    none = np.zeros((P, m, 3, rows.shape[1]))
    stretch = none.copy()
    stretch[:, :, 0] = rows[:, None]
    return replace(
        whole,
        moved=none,
        seen=none,
        tilted=stretch,
        turned=none,
        mix=np.broadcast_to(np.eye(3), (P, m, 3, 3)),
        log_scale=np.zeros(P),
        delay_s=np.zeros(P),
        decay_rad_s=np.zeros(P),
        sensor_mass_kg=np.zeros(P),
    )


def holding_back(found: Response, row: Array, torque: ComplexArray) -> Response:
    """Return a solution while a torque is held back along a row (P, N), which stays.

    `torque` (P, m, L): per unit force of each mounting's hit.
    """
    system = found.system
    by_torque = np.einsum("plij,pj->pil", found.H, row[:, found.moving])  # (P, n, L)
    at_sensor = real_times(system.moved, np.ascontiguousarray(by_torque)[:, None])
    x = found.x - torque[:, :, None] * by_torque[:, None]
    for a in range(3):
        pull = sum(found.S[:, :, a, b] * at_sensor[:, :, b] for b in range(3))
        x += found.HU[:, :, :, a] * (torque * np.asarray(pull))[:, :, None]
    seen = recorded(system.seen, system.tilted, found.s_rad_s, x)
    return replace(found, x=x, true_axes=seen * found.factor[:, None, None])


@dataclass(frozen=True, slots=True)
class SolvedTurns(Solved):
    """Solved postures of `turned_systems`; a joint's own row stays what it is."""

    rows: Array | None = None  # (P, N)

    def angle_slopes(self) -> Slopes:
        """Return how the equations change with the angles."""
        whole = Solved.angle_slopes(self)
        return replace(whole, **_none(whole, self.exact.hit.shape[1], 2))

    def motion_slopes(self, names: Sequence[str]) -> MotionSlopes:
        """Return how they change with what coordinates that give way move."""
        whole = Solved.motion_slopes(self, names)
        return replace(whole, **_none(whole, self.exact.hit.shape[1], 1))

    def systems(self, assemblies: Sequence[Assembly]) -> System:
        """Return equations of the same postures."""
        if self.rows is None:
            raise ValueError("wanted the rows along which joints turn")
        return turned_systems(assemblies, self.rows, self.exact.hit.shape[1])


def _none(slopes: Slopes | MotionSlopes, m: int, axis: int) -> dict[str, Any]:
    """What m mountings see of it: nothing."""
    found = {}
    for name in ("moved", "seen", "tilted"):
        shape = list(getattr(slopes, name).shape)
        shape[axis] = m
        found[name] = np.zeros(shape)
    return found
