"""First stiffnesses from frequencies alone: the penalty method, modes paired by shape.

References
----------
File 002, Eq. (13). The derivative of a frequency by a stiffness is the spring's share of the
mode's strain energy: d ln f² / d ln k_j = k_j φ_j² / (φᵀ K φ).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.arm.reduced import ReducedModel, reduce_model
from armodal.analyzer.arm.structure import Structure
from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.modal import ModalModel, Mode
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof

__all__ = ["MeasuredModes", "fit_to_frequencies", "pair_by_shape"]

Array = npt.NDArray[np.float64]

_MOST_STEPS = 30


class MeasuredModes:
    """Modes of a posture with the rows of the model that belong to their shapes.

    Parameters
    ----------
    shapes
        (n_dofs, n_modes) of the modes along `dofs`; their own at the responses when omitted.
    """

    def __init__(
        self,
        superset: Superset,
        dynamics: PostureDynamics,
        modes: tuple[Mode, ...],
        dofs: tuple[Dof, ...],
        shapes: npt.NDArray[np.complex128] | None = None,
    ) -> None:
        self.dynamics = dynamics
        self.modes = modes
        if shapes is None:
            shapes = np.zeros((len(dofs), len(modes)), dtype=np.complex128)
            for column, mode in enumerate(modes):
                shapes[:, column] = mode.shape
        self.shapes = shapes
        self.index = np.array([superset.point_index[dof.point] for dof in dofs])
        self.directions = np.array([dof.direction for dof in dofs])

    @classmethod
    def of(cls, superset: Superset, dynamics: PostureDynamics, model: ModalModel) -> MeasuredModes:
        """Take the shapes where they were measured at more points.

        With a roving hammer that is where it hit: by reciprocity a mode's participation is its
        shape along the hits.
        """
        hits = {dof.point for dof in model.references}
        roving_hammer = len(hits) > len({dof.point for dof in model.responses})
        if not roving_hammer or not model.modes:
            return cls(superset, dynamics, model.modes, model.responses)
        shapes = np.stack([mode.participation for mode in model.modes], axis=1)
        return cls(superset, dynamics, model.modes, model.references, shapes)

    def rows(self, jacobian: Array) -> Array:
        """Return (n_dofs, n) motion along the measured directions for each freedom."""
        return np.asarray(np.einsum("ri,rin->rn", self.directions, jacobian[self.index][:, :3]))


def pair_by_shape(measured: npt.ArrayLike, model: npt.ArrayLike) -> list[tuple[int, int, float]]:
    """Pair shapes one to one by the largest sum of MAC: (measured, model, MAC) triples."""
    a, b = np.asarray(measured), np.asarray(model)
    a = a / np.linalg.norm(a, axis=0)
    b = b / np.linalg.norm(b, axis=0)
    mac = np.abs(a.conj().T @ b) ** 2
    rows, columns = scipy.optimize.linear_sum_assignment(-mac)
    return [(int(i), int(j), float(mac[i, j])) for i, j in zip(rows, columns, strict=True)]


def shape_at(measured: MeasuredModes, model: ReducedModel, vectors: Array) -> Array:
    """Shapes (n_resp, n_modes) of a model at the measured directions."""
    return measured.rows(model.point_jacobian) @ vectors


def fit_to_frequencies(
    superset: Superset,
    structure: Structure,
    postures: tuple[MeasuredModes, ...],
    *,
    prior_std: float = 0.4,
) -> Structure:
    """Fit ln k of all springs of a structure to measured frequencies (file 002, Eq. 13).

    A pair weighs with its MAC squared, so a mode the structure cannot make has no say; a prior
    of `prior_std` on ln k keeps a spring that no mode strains where it was.

    Raises
    ------
    EstimateError
        If the springs are too soft to hold the arm against gravity in a measured posture.
    """
    first = np.log(structure.all_stiffness())
    log_k = first.copy()
    for _ in range(_MOST_STEPS):
        rows, rest = [np.eye(len(log_k)) / prior_std], [(first - log_k) / prior_std]
        for posture in postures:
            model = reduce_model(superset, posture.dynamics, _with_stiffness(structure, log_k))
            squares, vectors = scipy.linalg.eigh(model.stiffness, model.mass)
            if squares[0] <= 0.0:
                raise EstimateError(_topples(superset, structure, np.exp(log_k)))
            share = np.exp(log_k)[:, None] * vectors[: len(log_k)] ** 2 / squares
            for i, j, mac in pair_by_shape(posture.shapes, shape_at(posture, model, vectors)):
                weight = mac**2 / 0.02  # a pair of equal shape: one per cent of f
                target = np.log((2 * np.pi * posture.modes[i].f_hz) ** 2 / squares[j])
                rows.append(weight * share[None, :, j])
                rest.append(np.array([weight * target]))
        step = np.linalg.lstsq(np.concatenate(rows), np.concatenate(rest), rcond=None)[0]
        log_k = log_k + np.clip(step, -0.3, 0.3)
        if float(np.abs(step).max()) < 1e-6:
            break
    return _with_stiffness(structure, log_k)


def _topples(superset: Superset, structure: Structure, k: Array) -> str:
    names = [
        *(superset.arm.joints[joint].name for joint in structure.joints),
        *(f"axis in {superset.arm.joints[axis.link].link.name}" for axis in structure.axes),
    ]
    values = ", ".join(f"{name} {value:.4g}" for name, value in zip(names, k, strict=True))
    return (
        "wanted stiffnesses that hold the arm against gravity in every measured posture, got "
        f"{values} N m/rad: correct those of the arm file, which are in N m/rad"
    )


def _with_stiffness(structure: Structure, log_k: Array) -> Structure:
    n = len(structure.joints)
    return replace(
        structure,
        stiffness_n_m_per_rad=np.exp(log_k[:n]),
        axes=tuple(
            replace(axis, stiffness_n_m_per_rad=float(np.exp(value)))
            for axis, value in zip(structure.axes, log_k[n:], strict=True)
        ),
    )
