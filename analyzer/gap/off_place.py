"""What errors of one mounting's own change beside gains and tilts: its place, and its hits' aim.

A sensor is put to its point by hand, and every hit has an aim of its own. Both change all lines of
a mounting together, as a column each, and are integrated out with its gains and tilts
(`weigh.Weighing`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.ordinary import across
from armodal.analyzer.gap.priors import PLACE_STD_M
from armodal.analyzer.gap.response import Response
from armodal.protocols.arm.records import Tolerances

__all__ = ["off_place"]

ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def off_place(found: Response, tolerances: Tolerances) -> ComplexArray:
    """Change (P, m, 3, k, L) of each channel by a deviation of each of k errors."""
    shifts = found.by_shift() * PLACE_STD_M  # (3, P, m, 3, L)
    columns = [*shifts]
    hits = found.system.force  # (P, n_hits, 3)
    for side in range(2):
        aimed = np.zeros(shifts.shape[1:], dtype=shifts.dtype)
        for hit in range(hits.shape[1]):
            lengths = np.linalg.norm(hits[:, hit], axis=1, keepdims=True)
            sides = np.array([across(own)[:, side] for own in hits[:, hit] / lengths])
            aimed = aimed + found.by_force(hit, tolerances.hit_direction_rad * sides)
        columns.append(aimed)
    return np.stack(columns, axis=3)
