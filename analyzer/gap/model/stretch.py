"""An evenly soft stretch of a link's line, and by what part of its yield the link itself moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Stretch"]

Array = npt.NDArray[np.float64]

_LEAST = 1e-6  # of the length, over which a mean is taken


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """An evenly soft stretch of a link's line; m from the line's root.

    Its ends may move with q parameters, by as much a unit of each.
    """

    along: Array  # (3,) unit, link's frame
    length_m: float  # of the line
    start_m: float
    end_m: float
    start_slopes_m: tuple[float, ...] = ()  # (q,)
    end_slopes_m: tuple[float, ...] = ()

    def parts(self, at_m: Array) -> tuple[Array, Array, Array, Array]:
        """Return by which part what stands at (k,) turns, and how far before the hinge about.

        And the slopes (q, k) of both. The yields of a beam under an even moment: what stands at t
        turns by the part of the stretch before it, about the middle of that.
        """
        t, length_m = np.clip(at_m, self.start_m, self.end_m), self.end_m - self.start_m
        turns = t > self.start_m
        partly = turns & (t < self.end_m)
        by_start, by_end = self._slopes
        slope = by_start * (self.end_m - t) + by_end * (t - self.start_m)
        return (
            (t - self.start_m) / length_m,
            0.5 * (self.end_m - t),
            np.where(partly, -slope / length_m**2, 0.0),
            np.where(partly, 0.5 * by_end, 0.0),
        )

    def of_pieces(self, shares: Array) -> tuple[Array, Array, Array, Array]:
        """Return by which part pieces (P,) turn, and that part times how far before the hinge.

        And the slopes (q, P) of both. Means over each piece: they lie on the line one behind the
        other, and of any the part before the stretch stays.
        """
        ends = np.cumsum(shares)
        # A piece without mass still has a place.
        wide_m = np.maximum(shares, _LEAST) * self.length_m
        middles_m = (ends - 0.5 * shares) * self.length_m
        before = self._integrals(middles_m - 0.5 * wide_m)
        after = self._integrals(middles_m + 0.5 * wide_m)
        part, lever, by_part, by_lever = (
            (far - near) / wide_m for near, far in zip(before, after, strict=True)
        )
        return part, lever, by_part, by_lever

    def _integrals(self, at_m: Array) -> tuple[Array, Array, Array, Array]:
        """Integrals from the root up to (k,) of `parts`, of their product, and slopes (q, k).

        With x from the stretch's start, h its length: x^2 / 2 h, and of x (h - x) / 2 h.
        """
        h = self.end_m - self.start_m
        x, beyond = np.clip(at_m - self.start_m, 0.0, h), np.maximum(at_m - self.end_m, 0.0)
        by_start, by_end = self._slopes
        inside = (at_m > self.start_m) & (at_m < self.end_m)
        longer, dx = by_end - by_start, np.where(at_m >= self.end_m, by_end - by_start, 0.0)
        dx = np.where(inside, -by_start, dx)
        further = np.where(beyond > 0.0, -by_end, 0.0)
        return (
            x**2 / (2.0 * h) + beyond,
            x**2 / 4.0 - x**3 / (6.0 * h),
            x / h * dx - x**2 / (2.0 * h**2) * longer + further,
            (x / 2.0 - x**2 / (2.0 * h)) * dx + x**3 / (6.0 * h**2) * longer,
        )

    @property
    def _slopes(self) -> tuple[Array, Array]:
        """Of both ends, (q, 1) each."""
        return np.array(self.start_slopes_m)[:, None], np.array(self.end_slopes_m)[:, None]

    def turned_about(self, motion: Array, part: Array, lever_m: Array) -> Array:
        """(..., P, 6) of a link's motion (..., 6): parts (P,) of it, about what is before.

        `lever_m` (P,) is how far before the hinge, times the part.
        """
        turns = motion[..., None, 3:]
        moved = part[:, None] * motion[..., None, :]
        moved[..., :3] -= lever_m[:, None] * np.cross(self.along, turns)
        return np.asarray(moved)
