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

    Attributes
    ----------
    pole_rad_s : complex
        Upper half plane, rad/s; the decay of the lines is taken off.
    f_hz, f_std_hz : float
        Magnitude of the pole over 2 pi, and its standard deviation.
    damping_ratio, damping_std : float
        Of the critical damping, 1 being all of it, and its standard deviation.
    shape : (n_resp,) complex array
        Of the responses, in their directions; no unit.
    shape_std : (n_resp,) complex array
        Deviation of the real part, + j that of the imaginary part.
    participation : (n_ref,) complex array
        Of the references, m/(N s).
    participation_std : (n_ref,) complex array
        As `shape_std`, on its own best line, m/(N s).
    residue_std : float
        Of the largest residue's magnitude, relative: the size that both share.
    mpc : float
        Modal phase collinearity, 0 to 1.
    mpd_deg : float
        Mean phase deviation, degrees.
    mcf : float
        Modal complexity factor, 0 to 1.
    dof : float
        Student-t degrees of freedom of the deviations of frequency and damping.
    shape_dof : float
        Those of shape and participation; most of their scatter is the lines'.
    stability : float
        Share of the model orders at which the pole was seen.
    significance : float
        Rise of the misfit without the mode, over what noise alone would give.
    drift : ModeDrift or None
        Where the resonance moves from mounting to mounting; None: it does not.
    """

    pole_rad_s: complex
    f_hz: float
    f_std_hz: float
    damping_ratio: float
    damping_std: float
    shape: npt.NDArray[np.complex128]
    shape_std: npt.NDArray[np.complex128]
    participation: npt.NDArray[np.complex128]
    participation_std: npt.NDArray[np.complex128]
    residue_std: float
    mpc: float
    mpd_deg: float
    mcf: float
    dof: float
    shape_dof: float
    stability: float
    significance: float
    drift: ModeDrift | None = None

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

    Attributes
    ----------
    posture : str
        Its name.
    form : FrfForm
        Of the FRFs that were fitted.
    band_hz : (float, float)
        Of the fit.
    modes : tuple of Mode
        By rising frequency.
    background_rad_s : (n_background,) complex array
        Poles that are no modes.
    residual_terms : (n_resp, n_ref, 3 + 2 n_background) array
        See above.
    covariance : (2 n, 2 n) array
        Of (f_1, zeta_1, f_2, ...), Hz and 1.
    robust_covariance : bool
        Whether it is from the scatter between points; else from the variances of lines.
    synthesis_error : float
        RMS misfit over RMS of all FRFs in the band.
    frf_error : (n_resp, n_ref) array
        The same of each FRF; NaN: not measured.
    frac : (n_resp, n_ref) array
        Likeness of each FRF and its synthesis, 0 to 1; NaN: not measured.
    lack_of_fit : float
        Weighted misfit per degree of freedom; 1 where noise explains it.
    responses, references : tuple of Dof
        Point and direction (base frame) of each row and of each column.
    joints_rad : (n_joints,) array or None
        Joint angles as measured; None: not told.
    stabilisation : Stabilisation
        Poles over model orders.
    mountings : tuple of str
        What was measured at once: points of the longer side.
    mounting : (n_resp, n_ref) int array
        Of each FRF, from 0.
    notes : tuple of str
        What a person must know of the lines and peaks.
    """

    posture: str
    form: FrfForm
    band_hz: tuple[float, float]
    modes: tuple[Mode, ...]
    background_rad_s: npt.NDArray[np.complex128]
    residual_terms: npt.NDArray[np.float64]
    covariance: npt.NDArray[np.float64]
    robust_covariance: bool
    synthesis_error: float
    frf_error: npt.NDArray[np.float64]
    frac: npt.NDArray[np.float64]
    lack_of_fit: float
    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    joints_rad: npt.NDArray[np.float64] | None
    stabilisation: Stabilisation
    mountings: tuple[str, ...]
    mounting: npt.NDArray[np.int64]
    notes: tuple[str, ...]

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
