"""Where the wrist stands in the meridian plane, and the joint angles that bring it there.

The meridian plane is at right angles to the axes of shoulder and elbow, joints 2 and 3 of a
six-axis arm (file 002, section 2). In it a
point is a complex number, horizontal + i vertical, and a turn by q about the common axis
multiplies by e^{-iq} (the axis points away from who looks along horizontal x vertical).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.workspace.wrist import (
    PARALLEL,
    WristCentre,
    axis_lines,
    wrist_centre,
    wrist_joints,
)
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["ELBOWS", "MeridianPlane", "meridian_plane"]

Array = npt.NDArray[np.float64]

SHOULDER = 1  # joint, 0-based
ELBOWS = ("up", "down")
SHORTEST_M = 1e-3  # of upper arm and forearm


@dataclass(frozen=True, slots=True, kw_only=True)
class MeridianPlane:
    """The planar pair of shoulder and elbow that carries the wrist, all other joints held.

    Attributes
    ----------
    horizontal, vertical
        (3,) unit directions of the plane in base; vertical is against gravity.
    shoulder, elbow
        Numbers (0-based) of the two joints.
    held_rad
        (n_joints,) where all other joints stand: zero, or the end of the range nearest to it.
    wrist
        The wrist's centre with shoulder and elbow at zero.
    shoulder_m
        Position of the shoulder's axis in the plane, horizontal + i vertical.
    upper_m, lower_m
        From shoulder to elbow and from elbow to wrist at q = 0, as complex numbers.
    elbow_sign
        +1 where the elbow turns about the same direction as the shoulder, else -1.
    """

    arm: Arm
    horizontal: Array
    vertical: Array
    shoulder: int
    elbow: int
    held_rad: Array
    wrist: WristCentre
    shoulder_m: complex
    upper_m: complex
    lower_m: complex
    elbow_sign: int

    @property
    def reach_m(self) -> float:
        """Largest distance of the wrist from the shoulder's axis."""
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
            than shoulder and elbow are held.
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
        q = np.broadcast_to(self.held_rad, (*wanted.shape, len(self.held_rad))).copy()
        q[..., self.shoulder] = _into_range(q2, self.arm.joints[self.shoulder].range_rad)
        q[..., self.elbow] = _into_range(q3, self.arm.joints[self.elbow].range_rad)
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
                f"{away:.3f} m from the shoulder's axis, and the arm reaches {self.reach_m:.3f} m "
                "within the ranges of its joints; choose a place nearer, or the other elbow"
            )
        return q


def meridian_plane(arm: Arm) -> MeridianPlane:
    """Find the meridian plane of an arm of five joints or more.

    The shoulder is the second joint, the elbow the last joint before the wrist that is parallel to
    it: joint 3 of five and six joints, joint 4 of seven whose third turns the upper arm.

    Raises
    ------
    ArmError
        If the arm has fewer than five joints, its shoulder is not horizontal, no joint is parallel
        to it, or its wrist has no centre; the message says what to use instead.
    """
    wrist_joints(arm)
    ranges = np.array([joint.range_rad for joint in arm.joints])
    held = np.clip(np.zeros(len(arm.joints)), ranges[:, 0], ranges[:, 1])
    _, directions = axis_lines(arm, held)
    elbow = _elbow(arm, directions)
    # Shoulder and elbow are measured from zero; what they carry does not turn relative to them.
    held[[SHOULDER, elbow]] = 0.0
    points, directions = axis_lines(arm, held)
    axis, axis_3 = directions[SHOULDER], directions[elbow]
    up = -np.asarray(arm.gravity_m_s2) / np.linalg.norm(arm.gravity_m_s2)
    if abs(axis @ up) > PARALLEL:
        raise ArmError(
            f"{arm.joints[SHOULDER].name} of arm '{arm.name}' is not horizontal, so it has no "
            "meridian plane; use the statistics over random postures instead"
        )
    horizontal = np.cross(axis, up)
    wrist = wrist_centre(arm, held)

    def place(point: Array) -> complex:
        return complex(point @ horizontal, point @ up)

    upper = place(points[elbow]) - place(points[SHOULDER])
    lower = place(wrist.point_m) - place(points[elbow])
    if min(abs(upper), abs(lower)) < SHORTEST_M:
        raise ArmError(
            f"{arm.joints[SHOULDER].name}, {arm.joints[elbow].name} and the wrist of arm "
            f"'{arm.name}' do not carry one another: two of them are in one place of the meridian "
            "plane; use the statistics over random postures instead"
        )
    return MeridianPlane(
        arm=arm,
        horizontal=horizontal,
        vertical=up,
        shoulder=SHOULDER,
        elbow=elbow,
        held_rad=held,
        wrist=wrist,
        shoulder_m=place(points[SHOULDER]),
        upper_m=upper,
        lower_m=lower,
        elbow_sign=1 if axis @ axis_3 > 0 else -1,
    )


def _elbow(arm: Arm, directions: Array) -> int:
    """The last joint before the wrist that is parallel to the shoulder."""
    shoulder = directions[SHOULDER]
    before = range(SHOULDER + 1, wrist_joints(arm)[0])
    parallel = [i for i in before if np.linalg.norm(np.cross(shoulder, directions[i])) <= PARALLEL]
    if not parallel:
        names = ", ".join(arm.joints[i].name for i in before)
        raise ArmError(
            f"{arm.joints[SHOULDER].name} of arm '{arm.name}' and none of {names} are parallel, so "
            "it has no meridian plane; use the statistics over random postures instead"
        )
    return parallel[-1]


def _into_range(angle: Array, limits: tuple[float, float]) -> Array:
    """Add whole turns until the angle lies within the limits; NaN where none does."""
    low, high = limits
    turned = low + np.mod(angle - low, 2 * np.pi)
    return np.where(turned <= high, turned, np.nan)
