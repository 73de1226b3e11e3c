"""Real modes from complex ones, and modal masses from a driving point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.modes import ModalModel, Mode
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof

__all__ = ["MassScaling", "mass_scaling", "real_modes"]

_LEAST_REACH = 0.999  # of the hit's direction that the sensor's axes at the point span


@dataclass(frozen=True, slots=True, kw_only=True)
class MassScaling:
    """Modal mass of one mode, and its shape scaled to unit modal mass.

    The receptance residue between degrees of freedom i and j is
    shape_i shape_j / (2 j w_d), w_d = Im pole; for a real mode, shape_i shape_j is the modal
    constant over 1 kg.
    """

    shape: npt.NDArray[np.complex128]  # (n_resp,) or, roving hammer, (n_ref,); 1/sqrt(kg)
    driving_value: complex  # of that shape along the hit at the driving point, 1/sqrt(kg)
    modal_mass_kg: float  # of the shape scaled to largest magnitude 1
    modal_mass_std_kg: float
    phase_deg: float  # of the modal constant at the driving point; 0 for a real mode
    point: str  # the driving point

    @property
    def consistent(self) -> bool:
        """Whether force and response at the driving point agree in sign."""
        return abs(self.phase_deg) < 90.0


def real_modes(shapes: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Real shapes of complex ones, by the transformation nearest to a real one.

    Phi = Re + Im (Re^T Re)^-1 Re^T Im: the imaginary parts that are combinations of the real
    parts of all modes are taken into account, so that close modes are parted.

    Parameters
    ----------
    shapes
        (n_dof, n_modes), each turned to its best real line, n_dof at least n_modes.

    Returns
    -------
    (n_dof, n_modes) float64
        Each scaled to largest magnitude 1.

    Raises
    ------
    EstimateError
        If there are fewer degrees of freedom than modes or the real parts are dependent.

    References
    ----------
    Niedbal, Proc. IMAC II (1984) 1094.
    """
    Phi = np.asarray(shapes, dtype=np.complex128)
    if Phi.ndim != 2 or Phi.shape[0] < Phi.shape[1]:
        raise EstimateError(
            f"real modes need at least as many degrees of freedom as modes, got an array of "
            f"shape {Phi.shape}; leave modes out or measure more points"
        )
    if np.linalg.matrix_rank(Phi.real) < Phi.shape[1]:
        raise EstimateError(
            "real modes: the real parts of the shapes are dependent; leave out the repeated mode"
        )
    T = np.linalg.lstsq(Phi.real, Phi.imag, rcond=None)[0]
    real = Phi.real + Phi.imag @ T
    result: npt.NDArray[np.float64] = real / np.max(np.abs(real), axis=0)
    return result


def _driving_point(model: ModalModel) -> tuple[int, list[int], npt.NDArray[np.float64]]:
    """Reference, responses at its point, and their factors that make up the hit's direction."""
    for j, reference in enumerate(model.references):
        rows = [i for i, dof in enumerate(model.responses) if dof.point == reference.point]
        if not rows:
            continue
        D = np.stack([model.responses[i].direction for i in rows], axis=1)
        factor = np.linalg.lstsq(D, reference.direction, rcond=None)[0]
        if float(reference.direction @ (D @ factor)) > _LEAST_REACH:
            return j, rows, np.asarray(factor, dtype=np.float64)
    wanted = ", ".join(sorted({dof.point for dof in model.references}))
    raise EstimateError(
        "modal mass needs a driving point: a response measured at a hit point along the hit "
        f"(hit were {wanted}); measure there"
    )


def mass_scaling(model: ModalModel) -> tuple[MassScaling, ...]:
    """Modal masses and shapes of unit modal mass, from the driving point.

    Where responses are fewer than references (roving hammer) the shape is that of the hits.

    Raises
    ------
    EstimateError
        If no response was measured at a hit point along the hit.

    References
    ----------
    Ewins, Modal Testing, 2nd ed. (2000), section 2.4; r = shape^2 / (2 j w_d) is the residue of
    1 / (s^2 + 2 zeta w s + w^2).
    """
    j, rows, factor = _driving_point(model)
    hammer = len(model.references) > len(model.responses)
    return tuple(
        _scaled(mode, j, rows, factor, model.references[j], hammer=hammer) for mode in model.modes
    )


def _scaled(
    mode: Mode,
    j: int,
    rows: list[int],
    factor: npt.NDArray[np.float64],
    reference: Dof,
    *,
    hammer: bool,
) -> MassScaling:
    moved = complex(factor @ mode.shape[rows])
    driven = complex(mode.participation[j])
    constant = 2j * mode.pole_rad_s.imag * moved * driven
    if constant == 0.0:
        raise EstimateError(
            f"the mode at {mode.f_hz:.4g} Hz does not move point {reference.point} along the hit; "
            "its mass cannot be told from there: use another driving point"
        )
    driving = np.sqrt(constant)
    shape, known = (mode.participation, driven) if hammer else (mode.shape, moved)
    scaled = shape * (driving / known)
    mass = 1.0 / float(np.max(np.abs(scaled))) ** 2
    # m = |moved| / (2 w |driven|) for a shape of largest magnitude 1, and the size of both sides.
    parts = [mode.residue_std]
    std = np.abs(factor) @ np.maximum(mode.shape_std.real[rows], mode.shape_std.imag[rows])
    parts.append(float(std) / abs(moved))
    parts.append(float(np.max([mode.participation_std[j].real, mode.participation_std[j].imag])))
    parts[2] /= abs(driven)
    return MassScaling(
        shape=frozen_array(scaled, np.complex128),
        driving_value=complex(driving),
        modal_mass_kg=mass,
        modal_mass_std_kg=mass * float(np.sqrt(np.sum(np.square(parts)))),
        phase_deg=float(np.degrees(np.angle(constant))),
        point=reference.point,
    )
