"""Frequency responses, modes and their uncertainty."""

from armodal.analyzer.modal.chosen_hits import HitChoice, hit_choices
from armodal.analyzer.modal.correlation import frac, mac, mac_matrix, mcf, mpc, mpd_deg
from armodal.analyzer.modal.estimators import FrfEstimate, estimate_frf
from armodal.analyzer.modal.fit import fit_modes, fit_modes_at
from armodal.analyzer.modal.forms import convert_form
from armodal.analyzer.modal.frf import HitFrfs, SensorAxes, posture_frf, posture_hit_frfs
from armodal.analyzer.modal.indicators import (
    TrackedCmif,
    cmif,
    frf_sum,
    group_sums,
    mif,
    multivariate_mif,
    tracked_cmif,
)
from armodal.analyzer.modal.missing import MissingModeHint, missing_mode_hints
from armodal.analyzer.modal.modes import ModalModel, Mode, mode_receptance, synthesise
from armodal.analyzer.modal.plscf import Stabilisation, poles_plscf
from armodal.analyzer.modal.random_error import (
    RandomError,
    coherence_random_error,
    scatter_random_error,
)
from armodal.analyzer.modal.scaling import MassScaling, mass_scaling, real_modes
from armodal.analyzer.modal.spectra import HitSpectra, hit_frfs, hit_spectra
from armodal.analyzer.modal.stable_poles import stable_poles

__all__ = [
    "FrfEstimate",
    "HitChoice",
    "HitFrfs",
    "HitSpectra",
    "MassScaling",
    "MissingModeHint",
    "ModalModel",
    "Mode",
    "RandomError",
    "SensorAxes",
    "Stabilisation",
    "TrackedCmif",
    "cmif",
    "coherence_random_error",
    "convert_form",
    "estimate_frf",
    "fit_modes",
    "fit_modes_at",
    "frac",
    "frf_sum",
    "group_sums",
    "hit_choices",
    "hit_frfs",
    "hit_spectra",
    "mac",
    "mac_matrix",
    "mass_scaling",
    "mcf",
    "mif",
    "missing_mode_hints",
    "mode_receptance",
    "mpc",
    "mpd_deg",
    "multivariate_mif",
    "poles_plscf",
    "posture_frf",
    "posture_hit_frfs",
    "real_modes",
    "scatter_random_error",
    "stable_poles",
    "synthesise",
    "tracked_cmif",
]
