"""What a matrix fraction can be given of an FRF matrix with holes.

A polynomial over several references needs every FRF of every response it is given. Where FRFs were
not measured it gets the largest complete block, which tells close modes apart by their
participations; and one common denominator gets all that was measured, response by reference, so
that a mode which the block hardly shows is found too.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["Part", "complete_block", "complete_parts", "linked"]

# Index of a part of (n_long, n_short, ...): (n_responses of it, n_references of it, ...).
Part = tuple[slice | npt.NDArray[np.intp], slice | npt.NDArray[np.intp]]


def complete_block(
    measured: npt.NDArray[np.bool_],
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Rows and columns of a block without holes: those that hold the most are dropped first.

    >>> [part.tolist() for part in complete_block(np.array([[1, 1], [0, 1], [1, 1]], dtype=bool))]
    [[0, 2], [0, 1]]
    """
    rows, columns = (np.arange(n) for n in measured.shape)
    while True:
        holes = ~measured[np.ix_(rows, columns)]
        if not holes.any():
            return rows, columns
        of_row, of_column = holes.mean(axis=1), holes.mean(axis=0)
        if of_row.max() >= of_column.max():
            rows = np.delete(rows, int(np.argmax(of_row)))
        else:
            columns = np.delete(columns, int(np.argmax(of_column)))


def complete_parts(measured: npt.NDArray[np.bool_]) -> list[Part]:
    """Complete parts to estimate poles from, that with the most references first.

    Parameters
    ----------
    measured
        (n_long, n_short).
    """
    if measured.all():
        return [(slice(None), slice(None))]
    rows, columns = complete_block(measured)
    response, reference = np.nonzero(measured)
    parts: list[Part] = [(response[:, None], reference[:, None])]
    if min(rows.size, columns.size) > 1:
        parts.insert(0, (rows[:, None], columns[None, :]))
    return parts


def linked(measured: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Responses that are linked to the first one by references they share: (n_long,).

    One shape over all responses has a size only where they are all linked.
    """
    rows = np.zeros(measured.shape[0], dtype=bool)
    rows[0] = True
    while True:
        wider = measured[:, measured[rows].any(axis=0)].any(axis=1) | rows
        if np.array_equal(wider, rows):
            return rows
        rows = wider
