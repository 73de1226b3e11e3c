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

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["ElasticJoints", "Spectrum", "elastic_joints", "spectrum", "spectrum_of_mass"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ElasticJoints:
    """The joints that twist, and how they resist; all others are held rigid."""

    joints: tuple[int, ...]  # 0-based
    stiffness_n_m_per_rad: Array  # (n,)
    damping_n_m_s_per_rad: Array  # (n,)


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
