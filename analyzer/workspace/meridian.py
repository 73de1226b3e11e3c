"""Where the wrist stands in the meridian plane, and the joint angles that bring it there.

The meridian plane is at right angles to the axes of joints 2 and 3 (file 002, section 2). In it a
point is a complex number, horizontal + i vertical, and a turn by q about the common axis
multiplies by e^{-iq} (the axis points away from who looks along horizontal x vertical).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["ELBOWS", "MeridianPlane", "meridian_plane"]

Array = npt.NDArray[np.float64]

SHOULDER, ELBOW = 1, 2  # joints, 0-based
ELBOWS = ("up", "down")
WRIST = 4  # the joint whose origin is the wrist's centre, where joints 4 and 5 cross
PARALLEL = 1e-6  # rad between axes called parallel


@dataclass(frozen=True, slots=True, kw_only=True)
class MeridianPlane:
    """The planar pair of joints 2 and 3 that carries the wrist, joint 1 at zero.

    Attributes
    ----------
    horizontal, vertical
        (3,) unit directions of the plane in base; vertical is against gravity.
    shoulder_m
        Position of joint 2's axis in the plane, horizontal + i vertical.
    upper_m, lower_m
        From shoulder to elbow and from elbow to wrist at q = 0, as complex numbers.
    elbow_sign
        +1 where joint 3 turns about the same direction as joint 2, else -1.
    """

    arm: Arm
    horizontal: Array
    vertical: Array
    shoulder_m: complex
    upper_m: complex
    lower_m: complex
    elbow_sign: int

    @property
    def reach_m(self) -> float:
        """Largest distance of the wrist from joint 2's axis."""
        return abs(self.upper_m) + abs(self.lower_m)

    def joints(self, horizontal_m: Array, vertical_m: Array, elbow: str) -> Array:
        """Joint angles that bring the wrist to places in the plane.

        Parameters
        ----------
        horizontal_m, vertical_m
            Any one shape; places in the plane, measured from the base's origin.
        elbow
            "up" has the elbow above the line from shoulder to wrist where the wrist is in front
            of the shoulder; behind it the same branch goes on.

        Returns
        -------
        (*shape, n_joints) float64
            Radians; NaN where the place is out of reach or a joint out of its range. Joints other
            than 2 and 3 are at zero.
        """
        wanted = np.asarray(horizontal_m) + 1j * np.asarray(vertical_m) - self.shoulder_m
        upper, lower = abs(self.upper_m), abs(self.lower_m)
        cosine = (np.abs(wanted) ** 2 - upper**2 - lower**2) / (2 * upper * lower)
        reached = np.abs(cosine) <= 1.0
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        # Elbow up bends clockwise from the upper arm to the lower one.
        bend = -bend if elbow == "up" else bend
        q3 = self.elbow_sign * (np.angle(self.lower_m) - np.angle(self.upper_m) - bend)
        arm = self.upper_m + np.exp(-1j * self.elbow_sign * q3) * self.lower_m
        q2 = np.angle(arm) - np.angle(wanted)
        q = np.zeros((*wanted.shape, len(self.arm.joints)))
        q[..., SHOULDER] = _into_range(q2, self.arm.joints[SHOULDER].range_rad)
        q[..., ELBOW] = _into_range(q3, self.arm.joints[ELBOW].range_rad)
        q[~reached | np.isnan(q).any(axis=-1)] = np.nan
        return q

    def joints_at(self, horizontal_m: float, vertical_m: float, elbow: str) -> Array:
        """Joint angles (n_joints,) for one place.

        Raises
        ------
        ArmError
            If the wrist cannot stand there.
        """
        q = self.joints(np.array(horizontal_m), np.array(vertical_m), elbow)
        if np.isnan(q).any():
            away = abs(complex(horizontal_m, vertical_m) - self.shoulder_m)
            raise ArmError(
                f"the wrist of arm '{self.arm.name}' does not reach ({horizontal_m:.3f}, "
                f"{vertical_m:.3f}) m of the meridian plane with the elbow {elbow}: it is "
                f"{away:.3f} m from joint 2's axis, and the arm reaches {self.reach_m:.3f} m "
                "within the ranges of its joints; choose a place nearer, or the other elbow"
            )
        return q


def meridian_plane(arm: Arm) -> MeridianPlane:
    """Find the meridian plane of an arm.

    Raises
    ------
    ArmError
        If the arm has fewer than five joints, or joints 2 and 3 are not parallel and horizontal.
    """
    if len(arm.joints) <= WRIST:
        raise ArmError(
            f"arm '{arm.name}' has {len(arm.joints)} joints; maps over the wrist's position need "
            "joints 1 to 3 and a wrist of joints 4 and 5 behind them; use the statistics over "
            "random postures instead"
        )
    T = np.eye(4)
    placed = []
    for joint in arm.joints[: WRIST + 1]:
        T = T @ joint.T_parent_joint
        placed.append((T[:3, 3].copy(), T[:3, :3] @ joint.axis))
    (p2, axis), (p3, axis_3), (wrist, _) = placed[SHOULDER], placed[ELBOW], placed[WRIST]
    up = -np.asarray(arm.gravity_m_s2) / np.linalg.norm(arm.gravity_m_s2)
    if np.linalg.norm(np.cross(axis, axis_3)) > PARALLEL or abs(axis @ up) > PARALLEL:
        raise ArmError(
            f"joints 2 and 3 of arm '{arm.name}' are not parallel and horizontal, so it has no "
            "meridian plane; use the statistics over random postures instead"
        )
    horizontal = np.cross(axis, up)

    def place(point: Array) -> complex:
        return complex(point @ horizontal, point @ up)

    return MeridianPlane(
        arm=arm,
        horizontal=horizontal,
        vertical=up,
        shoulder_m=place(p2),
        upper_m=place(p3) - place(p2),
        lower_m=place(wrist) - place(p3),
        elbow_sign=1 if axis @ axis_3 > 0 else -1,
    )


def _into_range(angle: Array, limits: tuple[float, float]) -> Array:
    """Add whole turns until the angle lies within the limits; NaN where none does."""
    low, high = limits
    turned = low + np.mod(angle - low, 2 * np.pi)
    return np.where(turned <= high, turned, np.nan)
