"""A first belief of the drives' stiffness, from the arm's own inertia: to be replaced by a test.

Industrial arms have their first mode near 12 Hz whatever their size, stretched out; the joints
farther out, that carry less, are stiffer for what they carry. For joint j this is

    k_j = (2 pi 12 Hz)² M_max^(3/4) M_jj^(1/4),

with the largest M_jj over the postures, and M_max the largest of any joint. The two numbers are
fitted by eye to the drives of UR5 and xArm7 (`protocols/arm/arms/ur5.toml`,
`hil_sim/makers/arms/xarm7.py`), which it tells to a factor of 1.4; others may be off by 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.arm.records import Arm

__all__ = ["SOURCE", "STD", "Drive", "guessed_drives"]

FIRST_HZ = 12.0
HIGHEST_HZ = 200.0  # a joint whose own mode lies above is held for rigid
DAMPING_RATIO = 0.025
STD = 0.6  # relative
N_POSTURES = 2000
SOURCE = "guess from the arm's inertia, docs/own-arm.md; no test"


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """What is put in for one joint."""

    stiffness_n_m_per_rad: float
    damping_n_m_s_per_rad: float


def guessed_drives(arm: Arm, rng: np.random.Generator) -> tuple[Drive | None, ...]:
    """One for each joint; None where it is believed rigid."""
    mass = ArmBatch(arm).mass(random_postures(arm, N_POSTURES, rng))
    own = np.array([mass[j, j].max() for j in range(len(arm.joints))])
    omega = 2.0 * np.pi * FIRST_HZ
    drives = []
    for inertia in own:
        k = omega**2 * float(own.max() ** 0.75 * inertia**0.25)
        f_hz = np.sqrt(k / inertia) / (2.0 * np.pi)
        c = 2.0 * DAMPING_RATIO * float(np.sqrt(k * inertia))
        drives.append(
            None if f_hz > HIGHEST_HZ else Drive(stiffness_n_m_per_rad=k, damping_n_m_s_per_rad=c)
        )
    return tuple(drives)
