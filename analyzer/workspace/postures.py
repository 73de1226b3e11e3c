"""Random postures within the joint ranges, the same ones however the work is divided."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm

__all__ = ["CHUNK", "chunk_sizes", "random_postures"]

CHUNK = 4096  # postures at once: their arrays stay in a core's cache


def random_postures(
    arm: Arm, n: int, rng: np.random.Generator, *, still: tuple[int, ...] = ()
) -> npt.NDArray[np.float64]:
    """Postures drawn uniformly from the joint ranges.

    Parameters
    ----------
    still
        Joints (0-based) left at zero; file 002, section 6, leaves joint 1 there.

    Returns
    -------
    (n, n_joints) float64
        Radians.
    """
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    joints_rad = rng.uniform(low, high, size=(n, len(low)))
    joints_rad[:, list(still)] = 0.0
    return joints_rad


def chunk_sizes(n: int) -> list[int]:
    """Divide n postures into chunks."""
    return [CHUNK] * (n // CHUNK) + ([n % CHUNK] if n % CHUNK else [])
