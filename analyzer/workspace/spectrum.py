"""Frequencies, damping and shapes of many postures, joint springs only.

With a diagonal Kq (file 002, Eq. 3) the modes need no inverse: of S = Kq^-1/2 M Kq^-1/2 the
eigenvalues are 1/omega², and phi = omega Kq^-1/2 v is the shape of unit modal mass. The stiffness
of gravity is left out, as the paper does in its section 6; `gravity_torque` of the batch and the
planner say what it would add.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import REFERENCE_RAD_S
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = [
    "ElasticJoints",
    "ElasticTerms",
    "Spectrum",
    "elastic_joints",
    "spectrum",
    "spectrum_of_mass",
]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticTerms:
    """Matrices (n, n) of an arm whose file has effects, in place of single springs."""

    mass: Array  # beside the links'
    damping: Array
    stiffness: Array
    loss: Array  # stiffness times loss factor
    names: tuple[str, ...]  # of the n coordinates


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticJoints:
    """What twists, and how it resists; all else is held rigid."""

    joints: tuple[int, ...]  # 0-based rows of the batch's matrices
    stiffness_n_m_per_rad: Array  # (n,)
    damping_n_m_s_per_rad: Array  # (n,)
    terms: ElasticTerms | None = None  # None: single springs and dampers

    def names(self, arm: Arm) -> tuple[str, ...]:
        """Return what each of the n is of."""
        if self.terms is not None:
            return self.terms.names
        return tuple(arm.joints[joint].name for joint in self.joints)

    def yields(self, load: Array) -> Array:
        """Return (n, n_postures) how far each gives way under generalised loads of that shape."""
        if self.terms is None:
            return np.asarray(load / self.stiffness_n_m_per_rad[:, None])
        return np.asarray(np.linalg.solve(self.terms.stiffness, load))


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectrum:
    """Modes of many postures, lowest frequency first."""

    f_hz: Array  # (n_postures, n_modes)
    damping_ratio: Array  # (n_postures, n_modes)
    shape: Array  # (n_postures, n_joints, n_modes), unit modal mass


def elastic_joints(arm: Arm) -> ElasticJoints:
    """Return the joints to which the arm file gives a stiffness.

    Raises
    ------
    ArmError
        If there is none.
    """
    found = [
        (i, joint.stiffness.value, joint.damping.value if joint.damping else 0.0)
        for i, joint in enumerate(arm.joints)
        if joint.stiffness is not None
    ]
    if not found:
        raise ArmError(
            f"wanted at least one joint with a stiffness in arm '{arm.name}', it has none; "
            "add stiffness_n_m_per_rad to a joint of the arm file"
        )
    return ElasticJoints(
        joints=tuple(i for i, _, _ in found),
        stiffness_n_m_per_rad=np.array([k for _, k, _ in found]),
        damping_n_m_s_per_rad=np.array([c for _, _, c in found]),
    )


def spectrum(batch: ArmBatch, joints_rad: npt.ArrayLike, elastic: ElasticJoints) -> Spectrum:
    """Modes in every posture.

    Parameters
    ----------
    joints_rad
        (n_postures, n_joints).

    References
    ----------
    File 002, Eq. (3) for the modes, and Eq. (6) for the modal damping phiᵀ C phi, of which the
    ratio is zeta = phiᵀ C phi / (2 omega) with unit modal mass.
    """
    return spectrum_of_mass(batch.mass(joints_rad), elastic)


def spectrum_of_mass(mass: Array, elastic: ElasticJoints) -> Spectrum:
    """Modes of mass matrices (n_joints, n_joints, n_postures) of a whole arm."""
    if elastic.terms is not None:
        return _of_terms(mass, elastic.terms)
    chosen = np.array(elastic.joints)
    root = 1.0 / np.sqrt(elastic.stiffness_n_m_per_rad)
    scaled = mass[chosen[:, None], chosen] * np.outer(root, root)[..., None]
    inverse_square, vectors = np.linalg.eigh(np.ascontiguousarray(np.moveaxis(scaled, 2, 0)))
    # Lowest frequency first: the largest 1/omega² comes last.
    omega = 1.0 / np.sqrt(inverse_square[:, ::-1])
    shape = vectors[:, :, ::-1] * root[:, None] * omega[:, None, :]
    modal_damping = np.einsum("pim,i,pim->pm", shape, elastic.damping_n_m_s_per_rad, shape)
    return Spectrum(
        f_hz=omega / (2 * np.pi), damping_ratio=modal_damping / (2 * omega), shape=shape
    )


def _of_terms(mass: Array, terms: ElasticTerms) -> Spectrum:
    """Modes where springs are a matrix; damping and loss to first order, as modal damping is.

    With h(s) of `analyzer.corrected.posture`, a loss raises omega^2 by phi' L phi (2 / pi)
    ln(omega / omega_0) and the damping ratio by phi' L phi / (2 omega^2).
    """
    root = np.linalg.inv(np.linalg.cholesky(terms.stiffness))
    n = len(root)
    # One product over all postures: root (x) root on the flattened matrices.
    scaled = np.kron(root, root) @ (mass + terms.mass[..., None]).reshape(n * n, -1)
    inverse_square, vectors = np.linalg.eigh(scaled.T.reshape(-1, n, n))
    omega = 1.0 / np.sqrt(inverse_square)
    side_by_side = np.ascontiguousarray(vectors.transpose(1, 0, 2)).reshape(n, -1)

    def modal(matrix: Array) -> Array:
        """Phi' matrix phi over omega^2, with phi = omega root' v."""
        moved = (root @ matrix @ root.T) @ side_by_side
        return np.asarray((side_by_side * moved).sum(axis=0).reshape(-1, n))

    damping_ratio = 0.5 * omega * modal(terms.damping)
    shape = (root.T @ side_by_side).reshape(n, -1, n).transpose(1, 0, 2) * omega[:, None, :]
    if terms.loss.any():
        lost = modal(terms.loss)
        damping_ratio += 0.5 * lost
        omega = omega * np.sqrt(1.0 + lost * (2.0 / np.pi) * np.log(omega / REFERENCE_RAD_S))
    return Spectrum(
        f_hz=omega[:, ::-1] / (2 * np.pi),
        damping_ratio=damping_ratio[:, ::-1],
        shape=shape[:, :, ::-1],
    )
