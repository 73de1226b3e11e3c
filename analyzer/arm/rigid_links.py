"""The rigid links by pinocchio: masses, gravity, Jacobians. Nothing else calls that library.

It is loaded when an arm's dynamics are first asked for, so that measurements on plain structures
are analysed where it is not installed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm, InertialLink
from armodal.protocols.errors import MissingPackageError

__all__ = ["LinkDynamics", "RigidLinks", "base_alone"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkDynamics:
    """What pinocchio tells of one posture; columns are the superset's."""

    mass: Array  # (n, n)
    gravity_stiffness: Array  # (n, n), dg/dq, as it comes
    T_base_link: Array  # (n_links, 4, 4)
    world_jacobian: Array  # (1 + n_links, 6, n), base first, at the base's origin
    link_jacobian: Array  # (n_links, 6, n), each in its link's frame


def base_alone() -> LinkDynamics:
    """Return what a structure without joints has: the six freedoms of its base."""
    return LinkDynamics(
        mass=np.zeros((6, 6)),
        gravity_stiffness=np.zeros((6, 6)),
        T_base_link=np.zeros((0, 4, 4)),
        world_jacobian=np.eye(6)[None],
        link_jacobian=np.zeros((0, 6, 6)),
    )


class RigidLinks:
    """The arm as one pinocchio model, with a free interface of the base and of every link.

    Raises
    ------
    MissingPackageError
        If pinocchio is not installed.
    """

    def __init__(self, arm: Arm) -> None:
        pin = _pinocchio()
        model = pin.Model()
        model.gravity = pin.Motion(np.asarray(arm.gravity_m_s2, dtype=float), np.zeros(3))
        parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base root")
        self._base = parent
        self._links: list[int] = []
        for joint in arm.joints:
            placement = pin.SE3(joint.T_parent_joint[:3, :3], joint.T_parent_joint[:3, 3])
            drive = model.addJoint(
                parent, pin.JointModelRevoluteUnaligned(joint.axis), placement, joint.name
            )
            parent = model.addJoint(
                drive, pin.JointModelFreeFlyer(), pin.SE3.Identity(), f"{joint.link.name} root"
            )
            model.appendBodyToJoint(parent, _inertia(pin, joint.link), pin.SE3.Identity())
            self._links.append(parent)
        self._model = model
        self._neutral = pin.neutral(model)
        self._joint_q = [int(model.joints[i - 1].idx_q) for i in self._links]

    def posture(self, joints_rad: Array) -> LinkDynamics:
        """Evaluate a posture from (n_joints,) angles."""
        return self.postures((joints_rad,))[0]

    def postures(self, joints_rad: Iterable[Array]) -> tuple[LinkDynamics, ...]:
        """Evaluate postures from (n_joints,) angles of each, in one work space.

        Making the work space takes a hundred times as long as a posture in it.
        """
        data = self._model.createData()
        return tuple(self._evaluated(angles, data) for angles in joints_rad)

    def _evaluated(self, joints_rad: Array, data: Any) -> LinkDynamics:
        pin = _pinocchio()
        model = self._model
        q = self._configuration(joints_rad)
        mass = np.array(pin.crba(model, data, q))
        mass = np.triu(mass) + np.triu(mass, 1).T
        gravity = np.array(pin.computeGeneralizedGravityDerivatives(model, data, q))
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        world, local = pin.ReferenceFrame.WORLD, pin.ReferenceFrame.LOCAL
        return LinkDynamics(
            mass=mass,
            gravity_stiffness=gravity,
            T_base_link=np.stack([data.oMi[i].homogeneous for i in self._links]),
            world_jacobian=np.stack(
                [
                    np.array(pin.getJointJacobian(model, data, i, world))
                    for i in (self._base, *self._links)
                ]
            ),
            link_jacobian=np.stack(
                [np.array(pin.getJointJacobian(model, data, i, local)) for i in self._links]
            ),
        )

    def gravity_stiffness_per_mass(self, joints_rad: Array) -> Array:
        """Return dg/dq, (n_links, 4, n, n), of `Superset.gravity_stiffness_per_mass`."""
        pin = _pinocchio()
        q = self._configuration(joints_rad)
        model = self._model.copy()
        for i in range(1, model.njoints):
            model.inertias[i] = pin.Inertia.Zero()
        data = model.createData()
        result = np.zeros((len(self._links), 4, model.nv, model.nv))
        at = np.vstack([np.zeros(3), np.eye(3)])
        for number, link in enumerate(self._links):
            for i, center in enumerate(at):
                model.inertias[link] = pin.Inertia(1.0, center, np.zeros((3, 3)))
                derivative = pin.computeGeneralizedGravityDerivatives(model, data, q)
                result[number, i] = (derivative + derivative.T) / 2
            model.inertias[link] = pin.Inertia.Zero()
        result[:, 1:] -= result[:, :1]
        return result

    def _configuration(self, joints_rad: Array) -> Array:
        q: Array = self._neutral.copy()
        q[self._joint_q] = joints_rad
        return q


def _pinocchio() -> Any:
    try:
        return import_module("pinocchio")
    except ImportError as error:
        raise MissingPackageError(
            f"wanted the package pinocchio for the arm's dynamics, it cannot be loaded: {error}. "
            "Install it: `pip install pin` on Linux and macOS, `conda install -c conda-forge "
            "pinocchio` on Windows. Structures without joints are analysed without it"
        ) from error


def _inertia(pin: Any, link: InertialLink) -> Any:
    return pin.Inertia(link.mass_kg, np.asarray(link.center_m), np.asarray(link.inertia_kg_m2))
