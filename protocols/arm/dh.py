"""Modified Denavit-Hartenberg rows, as the papers print them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = ["dh_transform"]


def dh_transform(
    *, alpha_rad: float, a_m: float, theta_offset_rad: float, d_m: float
) -> npt.NDArray[np.float64]:
    """Pose of frame i in frame i-1 at joint angle zero, from a modified DH row.

    T = RotX(alpha_{i-1}) TransX(a_{i-1}) RotZ(theta_i + offset) TransZ(d_i); the joint turns
    about z of frame i.

    Returns
    -------
    (4, 4) float64
        Read-only pose, m.

    References
    ----------
    Craig, Introduction to Robotics, 3rd ed., Eq. (3.6).
    """
    ca, sa = math.cos(alpha_rad), math.sin(alpha_rad)
    ct, st = math.cos(theta_offset_rad), math.sin(theta_offset_rad)
    return frozen_array(
        [
            [ct, -st, 0.0, a_m],
            [st * ca, ct * ca, -sa, -sa * d_m],
            [st * sa, ct * sa, ca, ca * d_m],
            [0.0, 0.0, 0.0, 1.0],
        ],
        np.float64,
    )
