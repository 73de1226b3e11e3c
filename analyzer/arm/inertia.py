"""Moment of inertia of the outer arm about a joint axis, by hand.

The same number stands on the diagonal of the mass matrix; it is written out here because the
papers identify with it, and because two ways to one number check each other.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm

__all__ = ["moments_about_joints"]


def moments_about_joints(arm: Arm, T_base_link: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Moment of inertia about each joint axis of all links beyond it.

    Parameters
    ----------
    arm
        The arm.
    T_base_link
        (n_links, 4, 4) pose of every link's frame in base.

    Returns
    -------
    (n_joints,) float64
        kg m².

    References
    ----------
    File 002, Eqs. (8) and (9), Huygens-Steiner. Eq. (8) prints I_i inside the sum over the
    moving links j; it has to be I_j.
    """
    n = len(arm.joints)
    moments = np.zeros(n)
    for i, joint in enumerate(arm.joints):
        axis = T_base_link[i, :3, :3] @ joint.axis
        origin = T_base_link[i, :3, 3]
        for j in range(i, n):
            link = arm.joints[j].link
            R = T_base_link[j, :3, :3]
            inertia = R @ link.inertia_kg_m2 @ R.T
            arm_to_center = R @ link.center_m + T_base_link[j, :3, 3] - origin
            P = arm_to_center @ arm_to_center * np.eye(3) - np.outer(arm_to_center, arm_to_center)
            moments[i] += axis @ (inertia + link.mass_kg * P) @ axis
    return moments
