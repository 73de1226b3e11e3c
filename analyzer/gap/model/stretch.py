"""An evenly soft stretch of a link's line, and by what part of its yield the link itself moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Stretch"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """An evenly soft stretch of a link's line, about a place; m from the line's root."""

    along: Array  # (3,) unit, link's frame
    length_m: float  # of the line
    start_m: float
    end_m: float
    start_slope_m: float = 0.0  # by the place, a part of the length
    end_slope_m: float = 0.0

    def parts(self, at_m: Array) -> tuple[Array, Array, Array, Array]:
        """Return by which part what stands at (k,) turns, and how far before the hinge about.

        And the slopes of both by the place. The yields of a beam under an even moment: what stands
        at t turns by the part of the stretch before it, about the middle of that.
        """
        t, stretch = np.clip(at_m, self.start_m, self.end_m), self.end_m - self.start_m
        slope = self.start_slope_m * (self.end_m - t) + self.end_slope_m * (t - self.start_m)
        turns = t > self.start_m
        partly = turns & (t < self.end_m)
        return (
            (t - self.start_m) / stretch,
            0.5 * (self.end_m - t),
            np.where(partly, -slope / stretch**2, 0.0),
            np.where(partly, 0.5 * self.end_slope_m, 0.0),
        )

    def at(self, shares: Array) -> tuple[Array, Array, Array, Array]:
        """Return the same of a link's pieces, which lie on its line one behind the other."""
        ends = np.cumsum(shares)
        return self.parts((ends - 0.5 * shares) * self.length_m)

    def turned_about(self, motion: Array, back_m: Array) -> Array:
        """(..., P, 6) about `back_m` (P,) before the hinge, of a link's motion (..., 6)."""
        turns = motion[..., None, 3:]
        linear = motion[..., None, :3] - back_m[:, None] * np.cross(self.along, turns)
        return np.concatenate([linear, np.broadcast_to(turns, linear.shape)], axis=-1)
