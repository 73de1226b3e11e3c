"""Coupling of two joints in the mass matrix while one angle changes: file 002, Fig. 5."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.records import Arm

__all__ = ["CouplingSweep", "sweep_coupling"]

Array = npt.NDArray[np.float64]

_N_ANGLES = 1441  # of the sweep, before the zeros are refined


@dataclass(frozen=True, slots=True, kw_only=True)
class CouplingSweep:
    """M_ij against one joint's angle."""

    pair: tuple[int, int]  # 0-based
    angle_rad: Array  # (n,)
    to_first: Array  # (n,) M_ij / M_ii
    to_second: Array  # (n,) M_ij / M_jj
    zeros_rad: Array  # where M_ij is zero


def sweep_coupling(
    arm: Arm,
    pair: tuple[int, int],
    *,
    joint: int,
    limits_rad: tuple[float, float],
    batch: ArmBatch | None = None,
) -> CouplingSweep:
    """Sweep one joint, the others at zero, and follow the coupling of two.

    Parameters
    ----------
    joint
        The joint swept (0-based), over `limits_rad`; its own range does not limit it, as in the
        paper, whose zeros lie outside it.
    batch
        Of an arm with effects; the plain arm's otherwise.
    """
    angle = np.linspace(*limits_rad, _N_ANGLES)
    calculation = batch or ArmBatch(arm)

    def coupling(angles: Array) -> Array:
        q = np.zeros((len(angles), len(arm.joints)))
        q[:, joint] = angles
        return calculation.masses(q)[0]

    mass = coupling(angle)
    i, j = pair
    sign_change = np.flatnonzero(np.diff(np.signbit(mass[i, j])))
    low, high = angle[sign_change], angle[sign_change + 1]
    at_low = mass[i, j][sign_change]
    for _ in range(50):  # halves the bracket to the last bit
        middle = 0.5 * (low + high)
        value = coupling(middle)[i, j]
        same = np.signbit(value) == np.signbit(at_low)
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return CouplingSweep(
        pair=pair,
        angle_rad=angle,
        to_first=mass[i, j] / mass[i, i],
        to_second=mass[i, j] / mass[j, j],
        zeros_rad=0.5 * (low + high),
    )
