"""What errors of one mounting's own change beside gains and tilts: its place, its hits' and aim.

A sensor is put to its point by hand, and every hit has a place and an aim of its own. Each changes
all lines of a mounting together, as a column, and is integrated out with its gains and tilts
(`weigh.Weighing`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.priors import PLACE_STD_M
from armodal.analyzer.gap.model.response import Response
from armodal.protocols.arm.records import Tolerances

__all__ = ["mounting_error_columns"]

ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def mounting_error_columns(found: Response, tolerances: Tolerances) -> ComplexArray:
    """Change (P, m, 3, k, L) of each channel by a deviation of each of k errors."""
    shifts = found.by_shift() * PLACE_STD_M  # (3, P, m, 3, L)
    columns = [*shifts]
    hits = found.system.force  # (P, n_hits, 3)
    along = hits / np.linalg.norm(hits, axis=-1, keepdims=True)
    both_sides = np.array([[across(own) for own in of_posture] for of_posture in along])
    for side in range(2):
        sides = both_sides[..., side]  # (P, n_hits, 3)
        columns += [
            found.by_forces(tolerances.hit_direction_rad * sides),
            found.by_moments(PLACE_STD_M * np.cross(sides, hits)),
        ]
    return np.stack(columns, axis=3)
