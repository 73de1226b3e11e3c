"""Frequency responses, modes and their uncertainty."""

from armodal.analyzer.modal.band import lines_within, proposed_band
from armodal.analyzer.modal.chosen_hits import HitChoice, hit_choices
from armodal.analyzer.modal.correlation import frac, mac, mac_matrix, mcf, mpc, mpd_deg
from armodal.analyzer.modal.drift_causes import DriftTold, drift_told
from armodal.analyzer.modal.fit import fit_modes, fit_modes_at
from armodal.analyzer.modal.forms import convert_form
from armodal.analyzer.modal.frf import SensorAxes, posture_frf
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
from armodal.analyzer.modal.modes import ModalModel, Mode, synthesise
from armodal.analyzer.modal.plscf import Stabilisation
from armodal.analyzer.modal.random_error import (
    coherence_random_error,
    typical_random_errors,
)
from armodal.analyzer.modal.record_notes import band_of_hits, record_notes
from armodal.analyzer.modal.scaling import MassScaling, mass_scaling, real_modes
from armodal.analyzer.modal.spectra import HitSpectra, hit_frfs, hit_spectra
from armodal.analyzer.modal.stable_poles import stable_poles

__all__ = [
    "DriftTold",
    "HitChoice",
    "HitSpectra",
    "MassScaling",
    "MissingModeHint",
    "ModalModel",
    "Mode",
    "SensorAxes",
    "Stabilisation",
    "TrackedCmif",
    "band_of_hits",
    "cmif",
    "coherence_random_error",
    "convert_form",
    "drift_told",
    "fit_modes",
    "fit_modes_at",
    "frac",
    "frf_sum",
    "group_sums",
    "hit_choices",
    "hit_frfs",
    "hit_spectra",
    "lines_within",
    "mac",
    "mac_matrix",
    "mass_scaling",
    "mcf",
    "mif",
    "missing_mode_hints",
    "mpc",
    "mpd_deg",
    "multivariate_mif",
    "posture_frf",
    "proposed_band",
    "real_modes",
    "record_notes",
    "stable_poles",
    "synthesise",
    "tracked_cmif",
    "typical_random_errors",
]
