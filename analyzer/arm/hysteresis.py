"""A loss factor that is the same at every frequency, as a causal law."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

__all__ = ["REFERENCE_RAD_S", "hysteresis"]

# Where a joint with a loss factor has its stiffness k.
REFERENCE_RAD_S = 2.0 * np.pi * STIFFNESS_AT_HZ

ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def hysteresis(s: ComplexArray) -> ComplexArray:
    """Return what a unit loss factor adds to a unit stiffness at s, in rad/s.

    ln s has the imaginary part pi / 2 at every frequency: `docs/decisions/0007-loss-is-causal.md`.
    """
    return np.asarray((2.0 / np.pi) * np.log(s / REFERENCE_RAD_S))
