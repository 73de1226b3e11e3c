"""What a band cuts and what is broad stays in the fit, and is no mode."""

import numpy as np
from support.simulated_frfs import modal_frf, noisy_record, poles_of

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.modes import synthesise
from armodal.protocols.frf_records import FrfForm

# Two modes in the band; one 2 Hz above its end, one that is damped as no structure is.
IN_BAND_HZ, IN_BAND_DAMPING = (40.0, 70.0), (0.01, 0.01)
BESIDE_HZ, BESIDE_DAMPING = (102.0, 55.0), (0.02, 0.45)
FREQ_HZ = np.arange(15.0, 100.0, 0.25)


def measured(seed, level=0.002):
    rng = np.random.default_rng(seed)
    poles = poles_of([*IN_BAND_HZ, *BESIDE_HZ], [*IN_BAND_DAMPING, *BESIDE_DAMPING])
    residues = rng.uniform(0.5, 1.0, (4, 10, 1)) * rng.choice([-1.0, 1.0], (4, 10, 1))
    residues = residues / (2j * poles.imag[:, None, None])
    clean = modal_frf(poles, residues, FREQ_HZ, FrfForm.ACCELERANCE)
    return noisy_record(rng, clean, FREQ_HZ, form=FrfForm.ACCELERANCE, level=level)


def test_what_is_cut_and_what_is_broad_is_background_and_the_modes_are_right():
    for seed in range(6):
        frf = measured(seed)
        model = fit_modes(frf)
        near = [int(np.argmin(np.abs(model.f_hz - f))) for f in IN_BAND_HZ]
        for i, f, zeta in zip(near, IN_BAND_HZ, IN_BAND_DAMPING, strict=True):
            mode = model.modes[i]
            assert abs(mode.f_hz - f) < 4.0 * mode.f_std_hz  # of 12 modes one in 15000 by chance
            assert abs(mode.damping_ratio - zeta) < 4.0 * mode.damping_std
            assert mode.f_std_hz < 1e-3 * f
        assert model.background_rad_s.size
        assert any("a background is fitted, which is none of them" in n for n in model.notes)
        # Noise of 0.2 % of each FRF's RMS is all that is left.
        assert model.synthesis_error < 0.0025
        off = synthesise(model, frf.freq_hz) - frf.values
        assert np.sqrt(np.mean(np.abs(off) ** 2) / np.mean(np.abs(frf.values) ** 2)) < 0.0025


def test_modes_that_the_band_holds_need_no_background():
    rng = np.random.default_rng(0)
    poles = poles_of(IN_BAND_HZ, IN_BAND_DAMPING)
    residues = rng.uniform(0.5, 1.0, (2, 10, 1)) / (2j * poles.imag[:, None, None])
    clean = modal_frf(poles, residues, FREQ_HZ, FrfForm.ACCELERANCE)
    model = fit_modes(noisy_record(rng, clean, FREQ_HZ, form=FrfForm.ACCELERANCE, level=0.01))
    assert model.background_rad_s.size == 0
    assert model.notes == ()
    assert model.residual_terms.shape == (10, 1, 3)
    assert len(model.modes) == 2
