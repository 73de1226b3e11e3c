"""A posture that a user asks for, checked against the arm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["wanted_posture"]

_ROUNDING_RAD = 1e-4  # a limit typed with two decimals of a degree is still the limit


def wanted_posture(arm: Arm, posture_deg: Sequence[float]) -> npt.NDArray[np.float64]:
    """Joint angles in radians of a posture given in degrees.

    Raises
    ------
    ArmError
        If there are not as many as joints, or one lies outside its range.
    """
    if len(posture_deg) != len(arm.joints):
        raise ArmError(
            f"wanted {len(arm.joints)} joint angles in degrees for arm '{arm.name}', got "
            f"{len(posture_deg)}; give one per joint, separated by commas"
        )
    angles = np.deg2rad(posture_deg)
    for joint, angle, degrees in zip(arm.joints, angles, posture_deg, strict=True):
        low, high = joint.range_rad
        if not low - _ROUNDING_RAD <= angle <= high + _ROUNDING_RAD:
            raise ArmError(
                f"{joint.name} of arm '{arm.name}' turns from {np.rad2deg(low):g} to "
                f"{np.rad2deg(high):g} degrees, got {degrees:g}"
            )
    return np.asarray(angles)
