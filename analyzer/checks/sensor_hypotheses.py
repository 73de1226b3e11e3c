"""What can be wrong with a roving triaxial sensor: the 48 signed permutations and more."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
import numpy.typing as npt

from armodal.analyzer.checks.records import Fault
from armodal.protocols.arrays import frozen_array

__all__ = ["Hypothesis", "axis_text", "hypotheses", "signed_permutations"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One supposed fault, of n measured points.

    `correction` undoes it on the data, `rows` names the design's point whose rows each measured
    point takes.
    """

    fault: Fault | None
    at: tuple[int, ...]  # measured points, all of them for the roving sensor
    everywhere: bool
    text: str
    correction: Array  # (n, 3, 3)
    rows: npt.NDArray[np.int64]  # (n,)


def signed_permutations() -> Array:
    """All 48 signed permutation matrices (48, 3, 3), the identity first."""
    eye = np.eye(3)
    matrices = [
        np.diag(signs) @ eye[list(order)]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ]
    return np.stack(matrices)


def axis_text(correction: Array) -> str:
    """What the recorded x, y, z truly were, for a correction true = correction @ recorded."""
    names = "xyz"
    recorded_as = correction.T  # recorded = correction.T @ true
    parts = []
    for i, row in enumerate(recorded_as):
        j = int(np.argmax(np.abs(row)))
        sign = "-" if row[j] < 0 else ""
        if j != i or sign:
            parts.append(f"{names[i]} recorded {sign}{names[j]}")
    return ", ".join(parts)


def permutation_fault(correction: Array) -> Fault:
    """A diagonal correction is flipped signs, any other one swapped axes."""
    diagonal = bool(np.all(np.abs(np.diag(correction)) == 1.0))
    return Fault.SIGN_FLIPPED if diagonal else Fault.AXIS_SWAPPED


def hypotheses(index: npt.NDArray[np.int64], points: tuple[str, ...]) -> tuple[Hypothesis, ...]:
    """All discrete hypotheses, nothing wrong first.

    A sign common to all channels of all points leaves rigid motion rigid, so faults of the roving
    sensor come in pairs that no check of rigidity tells apart; the driving point does.

    Parameters
    ----------
    index
        (n,) measured points as indices into `points`.
    points
        Ids of all test points of the arm.
    """
    n = len(index)
    none = np.tile(np.eye(3), (n, 1, 1))

    def make(
        fault: Fault | None,
        at: tuple[int, ...],
        text: str,
        correction: Array = none,
        rows: npt.NDArray[np.int64] = index,
        *,
        everywhere: bool = False,
    ) -> Hypothesis:
        return Hypothesis(
            fault=fault,
            at=at,
            everywhere=everywhere,
            text=text,
            correction=frozen_array(correction, np.float64),
            rows=frozen_array(rows, np.int64),
        )

    found = [make(None, (), "nothing wrong")]
    everyone = tuple(range(n))
    for matrix in signed_permutations()[1:]:
        fault, text = permutation_fault(matrix), axis_text(matrix)
        if matrix.sum() > 0.0:  # of a pair of opposite signs, the one with fewer minus signs
            common = f"{text} (or the same with every sign reversed)"
            corrections = np.tile(matrix, (n, 1, 1))
            found.append(make(fault, everyone, common, corrections, everywhere=True))
        for p in range(n):
            correction = none.copy()
            correction[p] = matrix
            found.append(make(fault, (p,), text, correction))
    for p in range(n):
        for q in range(len(points)):
            if q == index[p]:
                continue
            rows = index.copy()
            rows[p] = q
            found.append(make(Fault.WRONG_POINT, (p,), f"it sat at point {points[q]}", rows=rows))
    for p in range(n):
        for q in range(p + 1, n):
            rows = index.copy()
            rows[[p, q]] = rows[[q, p]]
            text = "the two were exchanged"
            found.append(make(Fault.WRONG_POINT, (p, q), text, rows=rows))
    return tuple(found)
