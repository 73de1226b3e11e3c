"""What rigid links can do at the test points: rows of a linear map from unknown motion to sensors.

Two assumptions of different strength share one form. *Links*: every link moves as it likes, six
unknowns each. *Chain*: the first moving link moves as it likes (so that the foundation and its
structure may give), and each later joint adds one rotation about its own axis. An accelerometer
feels g x theta besides; within a link that is the same everywhere and hides in its acceleration,
along the chain each elastic joint adds one more unknown, a translation along g x axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.protocols.arrays import frozen_array

__all__ = ["Assembly", "RigidDesign", "rigid_design"]

Array = npt.NDArray[np.float64]


class Assembly(StrEnum):
    """How the links are held to hang together."""

    CHAIN = "chain"
    LINKS = "links"


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidDesign:
    """Rows per test point of the arm, sensor axes as described, for every point on a moving link.

    With x the unknown motion of one line, a sensor at point i reads `rows[i] @ x` and the link it
    rides on turns with `turning[i] @ x` (sensor axes). Points on the base have rows of zero.
    """

    points: tuple[str, ...]
    link: tuple[int, ...]  # -1 is the base
    rows: Array  # (n_points, 3, n_unknown)
    turning: Array  # (n_points, 3, n_unknown)
    position_m: Array  # (n_points, 3), base frame


def rigid_design(superset: Superset, dynamics: PostureDynamics, assembly: Assembly) -> RigidDesign:
    """Rows of rigid motion for all test points of an arm in a posture.

    References
    ----------
    Rigid motion of a point, v + w x r: file 000, Eq. (10). A specific-force sensor adds
    g x theta, which is the same at every point of a link and so is part of v.
    """
    position = dynamics.point_position
    rotation = dynamics.point_rotation
    link = superset.point_link
    first = min((i for i in link if i >= 0), default=0)
    twists = _chain_twists(superset, dynamics, first)
    if assembly is Assembly.LINKS:
        used = sorted({i for i in link if i >= 0})
        twists = {i: np.eye(6, 6 * len(used), k=6 * at).reshape(6, -1) for at, i in enumerate(used)}
    n_unknown = next(iter(twists.values())).shape[1] if twists else 6
    rows = np.zeros((len(link), 3, n_unknown))
    turning = np.zeros_like(rows)
    for i, on in enumerate(link):
        if on < 0:
            continue
        linear, angular = twists[on][:3], twists[on][3:]
        rows[i] = rotation[i].T @ (linear + np.cross(angular.T, position[i]).T)
        turning[i] = rotation[i].T @ angular
    return RigidDesign(
        points=tuple(point.id for point in superset.arm.points),
        link=link,
        rows=frozen_array(rows, np.float64),
        turning=frozen_array(turning, np.float64),
        position_m=frozen_array(position, np.float64),
    )


def _chain_twists(superset: Superset, dynamics: PostureDynamics, first: int) -> dict[int, Array]:
    """Twist at the base origin (6, 6 + 2 later joints) of every link from the first on."""
    n = superset.n_joints
    later = n - 1 - first
    result: dict[int, Array] = {}
    base = np.zeros((6, 6 + 2 * later))
    base[:, :6] = np.eye(6)
    for i in range(first, n):
        if i > first:
            T = dynamics.T_base_link[i]
            axis = T[:3, :3] @ superset.arm.joints[i].axis
            base = base.copy()
            column = 6 + i - 1 - first
            base[:3, column] = np.cross(T[:3, 3], axis)
            base[3:, column] = axis
            if superset.arm.joints[i].stiffness is not None:
                base[:3, column + later] = np.cross(dynamics.gravity_m_s2, axis)
        result[i] = base
    return result
