"""Poles of a stabilisation diagram that an order has in common with the one before."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.plscf import Stabilisation

__all__ = ["stable_poles"]

SAME_F, SAME_DAMPING = 0.01, 0.05  # relative, between consecutive orders: the usual criterion


def stable_poles(found: Stabilisation) -> npt.NDArray[np.bool_]:
    """Return which poles (n_poles,) the order before has too, by frequency and damping."""
    f_hz, damping = found.f_hz, found.damping_ratio
    stable = np.zeros(len(f_hz), dtype=bool)
    for before, order in pairwise(found.orders):
        new, old = found.order == order, found.order == before
        near_f = np.abs(f_hz[new][:, None] - f_hz[old]) <= SAME_F * f_hz[new][:, None]
        near_damping = (
            np.abs(damping[new][:, None] - damping[old])
            <= SAME_DAMPING * np.abs(damping[new])[:, None]
        )
        stable[new] = (near_f & near_damping).any(axis=1)
    return stable
