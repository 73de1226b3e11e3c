"""Frequency responses, modes and their uncertainty."""

from analyzer.modal.correlation import mac, mac_matrix, mcf, mpc, mpd_deg
from analyzer.modal.fit import fit_modes, fit_modes_at
from analyzer.modal.frf import HitSpectra, SensorAxes, hit_frfs, hit_spectra, posture_frf
from analyzer.modal.indicators import cmif, frf_sum, group_sums
from analyzer.modal.modes import ModalModel, Mode, mode_receptance, synthesise
from analyzer.modal.plscf import Stabilisation, poles_plscf

__all__ = [
    "HitSpectra",
    "ModalModel",
    "Mode",
    "SensorAxes",
    "Stabilisation",
    "cmif",
    "fit_modes",
    "fit_modes_at",
    "frf_sum",
    "group_sums",
    "hit_frfs",
    "hit_spectra",
    "mac",
    "mac_matrix",
    "mcf",
    "mode_receptance",
    "mpc",
    "mpd_deg",
    "poles_plscf",
    "posture_frf",
    "synthesise",
]
