"""Where a foreign file's nodes and directions lie on the arm, in one posture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import ToldDof

__all__ = ["HIT", "RESPONSE", "SCALAR", "Placement", "point_name"]

HIT, RESPONSE = "hit", "response"  # points of a plain structure that no file names
SCALAR = "scalar"  # label of a response whose direction is not told
UNTOLD_RESPONSE = (0.0, 0.0, 1.0)
UNTOLD_HIT = (0.0, 0.0, -1.0)


def point_name(node: str | None, nodes: Mapping[str, str], fallback: str) -> str:
    """Return the test point of a node: as the manifest maps it, else by its own name."""
    return fallback if node is None else nodes.get(node, node)


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """Nodes to test points, and file directions to the base frame.

    `axes` says whether the file's axes are those of the base or of the link a point is on.
    """

    arm: Arm
    joints_rad: npt.NDArray[np.float64]  # (n_joints,)
    axes: Literal["base", "link"]
    nodes: Mapping[str, str]

    @property
    def plain(self) -> bool:
        """Whether there is no arm, only a structure."""
        return not self.arm.joints

    def point(self, dof: ToldDof, fallback: str, origin: str) -> str:
        """Return the test point of a degree of freedom.

        Raises
        ------
        ForeignFileError
            If the arm has no such point, or none is told and there is an arm.
        """
        name = point_name(dof.node, self.nodes, fallback)
        if any(point.id == name for point in self.arm.points):
            return name
        came = "none" if dof.node is None else f"node {dof.node}"
        raise ForeignFileError(
            f"{origin}: wanted a point of arm {self.arm.name!r} as {fallback}, {came} came; map it "
            "with `nodes`, put it on a link with `links` and dataset 15, or name the degrees of "
            "freedom in the manifest"
        )

    def hit_point(self, told: str | None, dof: ToldDof, origin: str) -> str:
        """Return the test point hit: the manifest's where it tells one, else the file's.

        Raises
        ------
        ForeignFileError
            If the arm has no such point, or none is told and there is an arm.
        """
        return self.point(dof if told is None else ToldDof(told, None), HIT, origin)

    def direction(
        self, dof: ToldDof, point: str, what: str, origin: str
    ) -> npt.NDArray[np.float64]:
        """Return the unit vector of a degree of freedom in the base frame.

        Raises
        ------
        ForeignFileError
            If the direction is not told and there is an arm.
        """
        if dof.direction is None:
            if not self.plain:
                raise ForeignFileError(
                    f"{origin}: wanted the direction of the {what} at point {point}, the file does "
                    "not tell it; say it in the manifest"
                )
            return frozen_array(UNTOLD_HIT if what == HIT else UNTOLD_RESPONSE, np.float64)
        if self.axes == "base":
            return frozen_array(dof.direction, np.float64)
        R = link_pose(self.arm, self.arm.point(point).link, self.joints_rad)[:3, :3]
        return frozen_array(R @ dof.direction, np.float64)

    def sensor_axes(self, point: str) -> npt.NDArray[np.float64]:
        """Return the axes of the sensor mounted at a point, columns in the base frame."""
        place = self.arm.point(point)
        R: npt.NDArray[np.float64] = (
            link_pose(self.arm, place.link, self.joints_rad)[:3, :3] @ place.R_link_sensor
        )
        return R
