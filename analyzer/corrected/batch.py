"""Mass matrices and motions of a corrected arm in many postures at once.

The composite rigid body algorithm (R. Featherstone, Rigid Body Dynamics Algorithms (2008), section
6.2) on the chain of `analyzer.corrected.chain`: elements that nobody drives stand still.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.corrected.chain import Chain, Element, chain_of
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.workspace.batch import (
    ArmBatch,
    axis_to_z,
    flat_inertia,
    inertia_step,
    turn,
    turn_inertia,
    wrench_step,
)
from armodal.analyzer.workspace.spectrum import ElasticJoints, ElasticTerms, elastic_joints
from armodal.protocols.arm.records import Arm

__all__ = ["BatchedArm", "batched"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchedArm:
    """An arm for many postures, and what of it gives way."""

    batch: ArmBatch
    elastic: ElasticJoints
    titles: tuple[str, ...]  # of the effects it is computed with
    notes: tuple[str, ...]


def batched(arm: Arm) -> BatchedArm:
    """Prepare an arm, with its effects if it has any.

    Raises
    ------
    ArmError
        If no joint is elastic, or an effect is not the same in every posture.
    """
    if not arm.effects:
        return BatchedArm(batch=ArmBatch(arm), elastic=elastic_joints(arm), titles=(), notes=())
    elastic_joints(arm)
    correction = correction_of(arm)
    chain = chain_of(correction)
    elastic = ElasticJoints(
        joints=tuple(range(len(chain.names))),
        stiffness_n_m_per_rad=np.diag(chain.stiffness),
        damping_n_m_s_per_rad=np.diag(chain.damping),
        terms=ElasticTerms(
            mass=chain.mass,
            damping=chain.damping,
            stiffness=chain.stiffness,
            loss=chain.loss,
            names=chain.names,
        ),
    )
    return BatchedArm(
        batch=ChainBatch(arm, chain),
        elastic=elastic,
        titles=correction.titles,
        notes=correction.notes,
    )


class ChainBatch(ArmBatch):
    """An arm with elements nobody drives; rows of its matrices are the chain's coordinates."""

    def __init__(self, arm: Arm, chain: Chain) -> None:
        super().__init__(arm)
        self._chain = chain
        frames = [_frame(element) for element in chain.elements]
        self._steps = []
        for number, element in enumerate(chain.elements):
            R, p = frames[number]
            if number == 0:
                before, R0, p0 = -1, np.eye(3), np.zeros(3)
            else:
                before, (R0, p0) = chain.elements[number - 1].link, frames[number - 1]
            if element.link != before:  # from the parent link's frame, across the link's own joint
                T = arm.joints[element.link].T_parent_joint
                R, p = T[:3, :3] @ R, T[:3, :3] @ p + T[:3, 3]
            R, p = R0.T @ R, R0.T @ (p - p0)
            self._steps.append((inertia_step(R, p), wrench_step(R, p)))
        self._carried = [
            _parameters(element.inertia, *frame)
            for element, frame in zip(chain.elements, frames, strict=True)
        ]

    def mass(self, joints_rad: npt.ArrayLike) -> Array:
        """Mass matrices (n, n, n_postures) of the chain's coordinates, elements' inertia alone."""
        return self._combined(self._of_elements(joints_rad))

    def masses(self, joints_rad: npt.ArrayLike) -> tuple[Array, Array]:
        """Mass matrices of the arm's joints, and of the chain's coordinates."""
        mass = self._of_elements(joints_rad)
        joints = [i for i, element in enumerate(self._chain.elements) if element.joint is not None]
        return mass[np.ix_(joints, joints)], self._combined(mass)

    def _combined(self, mass: Array) -> Array:
        T = self._chain.combine
        at, by = np.nonzero(T)
        if len(by) == T.shape[1] and (T[at, by] == 1.0).all():  # each coordinate is one element
            rows = at[np.argsort(by)]
            return mass[np.ix_(rows, rows)]
        return np.asarray(np.einsum("ia,ijp,jb->abp", T, mass, T, optimize=True))

    def _of_elements(self, joints_rad: npt.ArrayLike) -> Array:
        cosine, sine = self._turns(np.asarray(joints_rad) + self._chain.offset_rad)
        elements, count = self._chain.elements, cosine.shape[1]
        mass = np.empty((len(elements), len(elements), count))
        composite = np.repeat(self._carried[-1][:, None], count, axis=1)
        for i in reversed(range(len(elements))):
            wrench = _momentum(composite, slides=elements[i].slides)
            mass[i, i] = wrench[2] if elements[i].slides else wrench[5]
            for j in reversed(range(i)):
                driven = elements[j + 1].joint
                if driven is not None:
                    turn(wrench, cosine[driven], sine[driven], ((0, 1), (3, 4)))
                wrench = self._steps[j + 1][1] @ wrench
                mass[i, j] = mass[j, i] = wrench[2] if elements[j].slides else wrench[5]
            if i:
                driven = elements[i].joint
                if driven is not None:
                    turn_inertia(composite, cosine[driven], sine[driven])
                composite = self._steps[i][0] @ composite + self._carried[i - 1][:, None]
        return mass

    def unit_motions(self, joints_rad: npt.ArrayLike, tool_m: npt.ArrayLike) -> tuple[Array, Array]:
        """Return (6, n, n_postures) motion of a tool point by each coordinate, and its place."""
        angles = np.asarray(joints_rad) + self._chain.offset_rad
        tool = self.position(angles, self.n_joints - 1, tool_m)
        found = np.empty((6, len(self._chain.elements), tool.shape[1]))
        for number, element in enumerate(self._chain.elements):
            origin = self._place(angles, element.link, element.point_m)
            along = self._place(angles, element.link, element.point_m + element.direction) - origin
            if element.slides:
                found[:3, number], found[3:, number] = along, 0.0
            else:
                found[:3, number] = np.cross(along, tool - origin, axis=0)
                found[3:, number] = along
        return np.einsum("ikp,ka->iap", found, self._chain.combine), tool

    def _place(self, angles: Array, link: int, point: Array) -> Array:
        if link < 0:
            return np.repeat(point[:, None], len(angles), axis=1)
        return self.position(angles, link, point)


def _frame(element: Element) -> tuple[Array, Array]:
    """Rotation and place, in its link's frame, of a frame whose z is the element's direction."""
    return axis_to_z(element.direction), element.point_m


def _parameters(inertia: Array, R: Array, p: Array) -> Array:
    """(10,) inertial parameters about an element's frame of (6, 6) about its link's."""
    moment = inertia[3:, :3]
    h = np.array([moment[2, 1], moment[0, 2], moment[1, 0]])
    return np.asarray(inertia_step(R.T, -R.T @ p) @ flat_inertia(inertia[0, 0], h, inertia[3:, 3:]))


def _momentum(composite: Array, *, slides: bool) -> Array:
    """(6, n_postures) momentum of bodies moving along or about z by one, linear first."""
    wrench = np.zeros((6, composite.shape[1]))
    if slides:
        wrench[2], wrench[3] = composite[0], composite[2]
        np.negative(composite[1], out=wrench[4])
    else:
        np.negative(composite[2], out=wrench[0])
        wrench[1] = composite[1]
        wrench[3], wrench[4], wrench[5] = composite[8], composite[9], composite[6]
    return wrench
