"""The equations a plan is made with: an arm's elastic joints, and what its file's effects add.

What an effect lets give way is a coordinate beside the joints. Postures are looked for by how alone
the joints stand in the mass matrix; what a hit excites, which points see it and how well a test
tells the stiffnesses comes from the whole equations.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.correction import Correction, correction_of
from armodal.analyzer.corrected.held import with_bodies
from armodal.analyzer.corrected.posture import assembly_at, corrected_posture, stand
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints, elastic_joints
from armodal.protocols.arm.records import Arm

__all__ = ["Equations", "PlannedArm", "planned_arm"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Equations:
    """About rest in a posture: n coordinates, the elastic joints first."""

    mass: Array  # (n, n)
    spring: Array  # (n, n); where the arm has effects gravity's small stiffness is in it
    gravity: Array  # (n, n) beside `spring`
    damping: Array  # (n, n)
    loss: Array  # (n, n) stiffness times loss factor
    joint_gravity: Array  # (n_elastic,) gravity's stiffness of each joint
    point_linear: Array  # (n_points, 3, n), base axes
    point_rotation: Array  # (n_points, 3, 3), columns are the sensor's axes in base


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedArm:
    """An arm prepared for a plan."""

    arm: Arm  # without effects; the bodies they put on links are in the links
    elastic: ElasticJoints
    superset: Superset  # of `arm`
    batch: ArmBatch  # of `arm`
    correction: Correction | None  # None without effects
    beside: Array  # (n_elastic, n_elastic) mass of joints that no link has: rotors, couplings

    @property
    def notes(self) -> tuple[str, ...]:
        """Return what the plan counts with, and what it does not."""
        if self.correction is None:
            return ()
        counted = [f"planned with: {', '.join(self.correction.titles)}"] * bool(
            self.correction.titles
        )
        own, theirs = (
            [joint.link.mass_kg for joint in arm.joints]
            for arm in (self.arm, self.correction.ordinary.arm)
        )
        if own != theirs:
            counted.append("the room that its payload takes is not known")
        return (*counted, *self.correction.notes)

    def joint_mass(self, joints_rad: npt.ArrayLike) -> Array:
        """Mass matrices (n_elastic, n_elastic, n_postures) of the elastic joints."""
        chosen = np.array(self.elastic.joints)
        mass = self.batch.mass(np.asarray(joints_rad))[chosen[:, None], chosen]
        return np.asarray(mass + self.beside[..., None])

    def at(self, joints_rad: npt.ArrayLike) -> Equations:
        """Evaluate a posture (n_joints,).

        Raises
        ------
        ArmError
            If the number of angles is not the arm's or one is not finite.
        """
        dynamics = self.superset.posture(joints_rad)
        columns = [self.superset.joint_column(joint) for joint in self.elastic.joints]
        chosen = np.ix_(columns, columns)
        if self.correction is not None:
            return _corrected(
                self.correction, joints_rad, np.diag(dynamics.gravity_stiffness[chosen])
            )
        return Equations(
            mass=dynamics.mass[chosen],
            spring=np.diag(self.elastic.stiffness_n_m_per_rad),
            gravity=dynamics.gravity_stiffness[chosen],
            damping=np.diag(self.elastic.damping_n_m_s_per_rad),
            loss=np.zeros((len(columns), len(columns))),
            joint_gravity=np.diag(dynamics.gravity_stiffness[chosen]),
            point_linear=dynamics.point_jacobian[:, :3][:, :, columns],
            point_rotation=dynamics.point_rotation,
        )


def planned_arm(arm: Arm) -> PlannedArm:
    """Prepare an arm, with the effects of its file.

    Raises
    ------
    ArmError
        If no joint is elastic, or an effect is not the library's or lacks a parameter.
    """
    elastic = elastic_joints(arm)
    n = len(elastic.joints)
    if not arm.effects:
        return PlannedArm(
            arm=arm,
            elastic=elastic,
            superset=Superset(arm),
            batch=ArmBatch(arm),
            correction=None,
            beside=np.zeros((n, n)),
        )
    correction = correction_of(arm)
    middle = np.array([0.5 * sum(joint.range_rad) for joint in arm.joints])
    loaded = replace(
        with_bodies(arm, assembly_at(correction, stand(correction, middle))), effects=()
    )
    found = PlannedArm(
        arm=loaded,
        elastic=elastic,
        superset=Superset(loaded),
        batch=ArmBatch(loaded),
        correction=correction,
        beside=np.zeros((n, n)),
    )
    beside = found.at(middle).mass[:n, :n] - found.joint_mass(middle[None])[..., 0]
    return replace(found, beside=beside)


def _corrected(correction: Correction, joints_rad: npt.ArrayLike, gravity: Array) -> Equations:
    at = stand(correction, joints_rad)
    own = corrected_posture(correction, at)
    joints = [correction.ordinary.arm.joints[i].name for i in correction.ordinary.elastic]
    order = [own.names.index(name) for name in joints]
    order += [i for i in range(len(own.names)) if i not in order]
    chosen = np.ix_(order, order)
    return Equations(
        mass=own.mass[chosen],
        spring=own.stiffness[chosen],
        gravity=np.zeros_like(own.mass),
        damping=own.damping[chosen],
        loss=own.loss[chosen],
        joint_gravity=gravity,
        point_linear=own.point_linear[..., order],
        point_rotation=at.geometry.point_rotation,
    )
