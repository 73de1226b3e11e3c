"""Which lines are fitted, and with what variance."""

import numpy as np
import pytest
from support.simulated_frfs import EIGHT_HZ, eight_modes, record

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.lines import fitted_lines, misfit_variance
from armodal.protocols.frf_records import FrfForm


def blown_up(rng, frf, times):
    """Drift, integrated twice: at the first line `times` the largest FRF, falling with f^-4."""
    lines = (frf.freq_hz[0] / frf.freq_hz) ** 4
    shape = frf.values.shape
    noise = (rng.normal(size=shape) + 1j * rng.normal(size=shape)) * lines
    return record(frf.values + times * np.abs(frf.values).max() * noise, frf.freq_hz, form=frf.form)


@pytest.mark.parametrize("times", [1e2, 1e4])
def test_lines_that_integration_blew_up_are_left_out_and_said(times):
    rng = np.random.default_rng(round(np.log10(times)))
    frf = eight_modes(rng, form=FrfForm.RECEPTANCE, n_resp=12).frf
    model = fit_modes(blown_up(rng, frf, times))
    assert any("are left out" in note for note in model.notes)
    # A mode is seen where what is left of the noise is small beside it.
    size = np.abs(frf.values).max(axis=(0, 1))
    left = times * size.max() * (frf.freq_hz[0] / frf.freq_hz) ** 4
    for f_hz in EIGHT_HZ:
        line = int(np.argmin(np.abs(frf.freq_hz - f_hz)))
        if left[line] < 0.01 * size[line]:
            assert np.min(np.abs(model.f_hz - f_hz)) < 0.02 * f_hz


def test_clean_lines_are_all_kept():
    frf = eight_modes(np.random.default_rng(1)).frf
    lines = fitted_lines(frf, None)
    assert lines.notes == ()
    assert lines.freq_hz.size == frf.freq_hz.size
    assert lines.told
    assert not fitted_lines(record(frf.values, frf.freq_hz, form=frf.form), None).told


def test_a_misfit_tells_the_noise_it_was_made_of():
    rng = np.random.default_rng(2)
    shape = (4, 2, 4000)
    size = np.where(np.abs(np.arange(4000) - 2000) < 8, 100.0, 1.0) * np.ones(shape)
    unit = (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)
    for floor, relative in ((0.3, 0.0), (0.1, 0.2)):
        left = np.sqrt(floor**2 + (relative * size) ** 2) * unit
        found = misfit_variance(left, size.astype(complex), 1.0, np.ones(shape[:2], dtype=bool))
        want = floor**2 + (relative * size) ** 2
        # Away from the peak eight FRFs and nine lines are averaged: 72 values, 12 % of a variance.
        flat = np.r_[100:1900, 2100:3900]
        assert np.median((found / want)[..., flat]) == pytest.approx(1.0, abs=0.3)
        # At the peak it is never taken for better than it is.
        assert np.median((found / want)[..., 1994:2006]) > 0.8


def test_what_falls_smoothly_from_zero_hertz_hides_no_peak():
    """A milling tool's receptances, 1e5 of its peaks at 1 Hz, had no mode at all."""
    rng = np.random.default_rng(5)
    frf = eight_modes(rng, form=FrfForm.RECEPTANCE, n_resp=12).frf
    size = rng.normal(size=(*frf.values.shape[:2], 1)) * np.exp(1j * rng.uniform(0.0, 3.0))
    drift = 1e5 * np.abs(frf.values).max() * size * (frf.freq_hz[0] / frf.freq_hz) ** 5
    model = fit_modes(record(frf.values + drift, frf.freq_hz, form=frf.form))
    assert any("outweighs every peak" in note for note in model.notes)
    high = EIGHT_HZ[model.band_hz[0] < EIGHT_HZ]
    # The drift has come down to the highest peak; half a per cent of f is a fifth of a bandwidth.
    assert high.size >= 7
    for f_hz in high:
        assert np.min(np.abs(model.f_hz - f_hz)) < 0.005 * f_hz
    asked = fitted_lines(frf, (5.0, 150.0))
    assert asked.notes == ()
