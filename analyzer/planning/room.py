"""What a plan has to know of the room an arm stands in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Room"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """Asked of every posture a plan may take."""

    free: Callable[[Array], npt.NDArray[np.bool_]]  # (n, n_joints) rad -> (n,)
    reachable: Callable[[Array], frozenset[str]]  # (n_joints,) rad -> ids of points
    path_clear: Callable[[Array, Array], bool]  # straight in the joints' angles
