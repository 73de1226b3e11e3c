"""Derivatives of predictions by every parameter of a space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["Columns"]

ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Columns:
    """Derivatives by n parameters; those that act on one mounting alone stand apart.

    A quarter of all parameters are places of points: kept as whole columns they would be a quarter
    of the work and nearly all zero. Of parameters that are in neither all derivatives are zero.
    """

    n: int
    rows: Indices  # (k,) parameters of `shared`
    shared: ComplexArray  # (k, P, m, 3, L)
    own_rows: Indices  # (j, P, m) parameters of `own`
    own: ComplexArray  # (j, P, m, 3, L)

    @classmethod
    def of(cls, dy: ComplexArray) -> Columns:
        """Return whole derivatives (n, P, m, 3, L) as such."""
        n, P, m, _, L = dy.shape
        return cls(
            n=n,
            rows=np.arange(n),
            shared=dy,
            own_rows=np.zeros((0, P, m), dtype=np.int64),
            own=np.zeros((0, P, m, 3, L), dtype=dy.dtype),
        )

    def beside(self, more: ComplexArray) -> Columns:
        """Return them with further ones (i, P, m, 3, L), counted from n."""
        return Columns(
            n=self.n + len(more),
            rows=np.append(self.rows, self.n + np.arange(len(more))),
            shared=np.concatenate([self.shared, more]),
            own_rows=self.own_rows,
            own=self.own,
        )

    def of_posture(self, at: int) -> Columns:
        """Return those of one of the P postures alone."""
        here = slice(at, at + 1)
        return Columns(
            n=self.n,
            rows=self.rows,
            shared=self.shared[:, here],
            own_rows=self.own_rows[:, here],
            own=self.own[:, here],
        )

    def whole(self) -> ComplexArray:
        """(n, P, m, 3, L)."""
        found = np.zeros((self.n, *self.shared.shape[1:]), dtype=self.shared.dtype)
        found[self.rows] = self.shared
        _, P, m = self.own_rows.shape
        for rows, own in zip(self.own_rows, self.own, strict=True):
            found[rows, np.arange(P)[:, None], np.arange(m)] += own
        return found
