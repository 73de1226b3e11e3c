"""What of the superset is free, and how stiff: the structure a model assumes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm

__all__ = ["Axis", "Held", "Structure", "believed_structure"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """A compliance axis at the root of a link: a revolute joint nobody drives.

    The axis is a line of the link's frame; `point_m` is its point nearest the frame's origin.
    """

    link: int  # 0-based index of the joint that moves the link
    direction: npt.NDArray[np.float64]  # (3,) unit
    point_m: npt.NDArray[np.float64]  # (3,), orthogonal to direction
    stiffness_n_m_per_rad: float
    damping_n_m_s_per_rad: float

    def twist(self) -> npt.NDArray[np.float64]:
        """Return the (6,) twist, linear first, of a unit rotation about the axis."""
        return np.concatenate([np.cross(self.point_m, self.direction), self.direction])


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """What gives way beside and stays as it is: m freedoms; matrices of the joints, then these."""

    names: tuple[str, ...]  # (m,)
    motion: npt.NDArray[np.float64]  # (superset.n, m)
    mass: npt.NDArray[np.float64]  # (n_joints_elastic + m,) * 2, beside the links'
    damping: npt.NDArray[np.float64]  # likewise, beside the joints' own
    stiffness: npt.NDArray[np.float64]  # likewise


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """The elastic freedoms of a model: some joints, then axes, then what is held, in this order."""

    joints: tuple[int, ...]  # 0-based
    stiffness_n_m_per_rad: npt.NDArray[np.float64]  # (n_joints_elastic,)
    damping_n_m_s_per_rad: npt.NDArray[np.float64]  # (n_joints_elastic,)
    axes: tuple[Axis, ...] = ()
    held: Held | None = None

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return len(self.joints) + len(self.axes) + (len(self.held.names) if self.held else 0)

    def springs(self) -> npt.NDArray[np.float64]:
        """Return (n, n) stiffness of joints, axes and what is held."""
        return self._filled(
            self.all_stiffness(), None if self.held is None else self.held.stiffness
        )

    def dampers(self) -> npt.NDArray[np.float64]:
        """Return (n, n) damping of joints, axes and what is held."""
        return self._filled(self.all_damping(), None if self.held is None else self.held.damping)

    def held_mass(self) -> npt.NDArray[np.float64]:
        """Return (n, n) inertia beside the links'."""
        return self._filled(
            np.zeros(len(self.joints) + len(self.axes)),
            None if self.held is None else self.held.mass,
        )

    def held_alone(self) -> Structure:
        """Return the same freedoms with joints that resist nothing: what is beside their own."""
        still = np.zeros(len(self.joints))
        return replace(self, stiffness_n_m_per_rad=still, damping_n_m_s_per_rad=still)

    def _filled(
        self, own: npt.NDArray[np.float64], held: npt.NDArray[np.float64] | None
    ) -> npt.NDArray[np.float64]:
        found = np.zeros((self.n, self.n))
        found[range(len(own)), range(len(own))] = own
        if held is not None:
            at = [*range(len(self.joints)), *range(len(own), self.n)]
            found[np.ix_(at, at)] += held
        return found

    def all_stiffness(self) -> npt.NDArray[np.float64]:
        """Return (n_joints + n_axes,) stiffness of joints, then axes."""
        return np.append(
            self.stiffness_n_m_per_rad, [axis.stiffness_n_m_per_rad for axis in self.axes]
        )

    def all_damping(self) -> npt.NDArray[np.float64]:
        """Return (n_joints + n_axes,) damping of joints, then axes."""
        return np.append(
            self.damping_n_m_s_per_rad, [axis.damping_n_m_s_per_rad for axis in self.axes]
        )


def believed_structure(arm: Arm) -> Structure:
    """Return the structure the arm file believes in: its elastic joints and no axis."""
    elastic = [
        (i, joint.stiffness.value, joint.damping.value if joint.damping else 0.0)
        for i, joint in enumerate(arm.joints)
        if joint.stiffness is not None
    ]
    return Structure(
        joints=tuple(i for i, _, _ in elastic),
        stiffness_n_m_per_rad=np.array([k for _, k, _ in elastic]),
        damping_n_m_s_per_rad=np.array([c for _, _, c in elastic]),
    )
