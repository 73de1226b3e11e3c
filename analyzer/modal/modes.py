"""Records of a fitted modal model, and its synthesis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.drift import ModeDrift
from armodal.analyzer.modal.forms import derivative_order
from armodal.analyzer.modal.plscf import Stabilisation
from armodal.analyzer.modal.regression import residual_terms
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.arrays import frozen_array
from armodal.protocols.frf_records import Dof, FrfForm

__all__ = ["ModalModel", "Mode", "synthesise"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One mode: pole, shape, participation.

    The mode's receptance is shape participation^T / (s - pole) plus its conjugate. `shape` is
    turned so that its best line is real and scaled to a largest magnitude of 1; `participation`
    carries the rest, in m/(N s).
    """

    pole_rad_s: complex
    f_hz: float
    f_std_hz: float
    damping_ratio: float
    damping_std: float
    shape: npt.NDArray[np.complex128]  # (n_resp,)
    shape_std: npt.NDArray[np.complex128]  # (n_resp,) of the real part + j of the imaginary part
    participation: npt.NDArray[np.complex128]  # (n_ref,)
    participation_std: npt.NDArray[np.complex128]  # (n_ref,) alike, on its own best line
    residue_std: float  # of the largest residue's magnitude, relative: the size both share
    mpc: float
    mpd_deg: float
    mcf: float
    dof: float  # Student-t degrees of freedom of the standard deviations of f and damping
    shape_dof: float  # those of shape and participation: most of their scatter is the lines'
    stability: float  # share of the model orders at which the pole was seen
    significance: float  # rise of the misfit without the mode, over what noise alone would give
    drift: ModeDrift | None = None  # where its resonance moves from mounting to mounting

    @property
    def residues(self) -> npt.NDArray[np.complex128]:
        """Receptance residues shape participation^T: (n_resp, n_ref)."""
        return np.outer(self.shape, self.participation)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalModel:
    """Modes of one posture with the residual terms of every FRF.

    `residual_terms` are the real coefficients c of c_0 s^(d-2) + c_1 s^(d-1) + c_2 s^d, with
    d = 0, 1, 2 for receptance, mobility, accelerance: modes below the band, their damping and
    the damping of those above, modes above the band. Behind them stand those of Re and Im of the
    residue of each background pole, which is no mode.
    """

    posture: str
    form: FrfForm
    band_hz: tuple[float, float]
    modes: tuple[Mode, ...]
    background_rad_s: npt.NDArray[np.complex128]  # (n_background,)
    residual_terms: npt.NDArray[np.float64]  # (n_resp, n_ref, 3 + 2 n_background)
    covariance: npt.NDArray[np.float64]  # (2 n, 2 n) of (f_1, zeta_1, f_2, ...), Hz and 1
    robust_covariance: bool  # from the scatter between points; False: from line variances
    synthesis_error: float  # RMS misfit over RMS of all FRFs in the band
    frf_error: npt.NDArray[np.float64]  # (n_resp, n_ref), the same per FRF; NaN: not measured
    frac: npt.NDArray[np.float64]  # (n_resp, n_ref) likeness of each FRF and its synthesis, alike
    lack_of_fit: float  # weighted misfit per degree of freedom; 1 when noise explains it
    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    joints_rad: npt.NDArray[np.float64] | None
    stabilisation: Stabilisation
    mountings: tuple[str, ...]  # what was measured at once: points of the longer side
    mounting: npt.NDArray[np.int64]  # (n_resp, n_ref) of each FRF, from 0
    notes: tuple[str, ...]  # what a person must know of the lines and peaks

    @property
    def f_hz(self) -> npt.NDArray[np.float64]:
        """Natural frequencies of all modes: (n_modes,)."""
        return frozen_array([mode.f_hz for mode in self.modes], np.float64)

    @property
    def damping_ratio(self) -> npt.NDArray[np.float64]:
        """Damping ratios of all modes: (n_modes,)."""
        return frozen_array([mode.damping_ratio for mode in self.modes], np.float64)


def synthesise(
    model: ModalModel, freq_hz: npt.NDArray[np.float64], *, decay_rad_s: float = 0.0
) -> npt.NDArray[np.complex128]:
    """FRFs of the model, in the form it was fitted in: (n_resp, n_ref, n_freq).

    An FRF that was not measured is the sum of its modes in the band.

    Parameters
    ----------
    model
        The fitted model.
    freq_hz
        (n_freq,), > 0.
    decay_rad_s
        Real part of the lines; 0 for the FRF itself.
    """
    s = laplace_lines(freq_hz, decay_rad_s)
    total = model.residual_terms @ residual_terms(model.form, s, model.background_rad_s).T
    if model.modes:
        # Fitted as (p^d R)/(s - p); the polynomial rest of s^d R/(s - p) is in the residual terms.
        poles = np.array([mode.pole_rad_s for mode in model.modes])
        residues = np.stack(
            [mode.residues for mode in model.modes], axis=-1
        ) * poles ** derivative_order(model.form)
        drift = [mode.drift for mode in model.modes]
        for g in range(len(model.mountings)):
            own = np.where(model.mounting == g)
            here = np.array(
                [p if d is None else d.group_poles[g] for p, d in zip(poles, drift, strict=True)]
            )
            both = np.concatenate([residues[own], residues[own].conj()], axis=-1)
            total[own] += both @ (1.0 / (s - np.concatenate([here, here.conj()])[:, None]))
    result: npt.NDArray[np.complex128] = total
    return result
