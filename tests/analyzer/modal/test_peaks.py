"""What everybody sees has a mode, or is told."""

import numpy as np
import pytest
from support.simulated_frfs import record

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.peaks import Peak, peak_poles, standing_peaks, unexplained
from armodal.protocols.frf_records import FrfForm

FREQ = np.arange(1, 1601) * 0.3125


def receptance(f_hz, damping, *, scale=1.0):
    pole = 2.0 * np.pi * f_hz * (-damping + 1j * np.sqrt(1.0 - damping**2))
    s = 2j * np.pi * FREQ
    return scale * (1.0 / (s - pole) / 1j + 1j / (s - pole.conjugate()))[None, None, :]


def noise(rng, level):
    shape = (1, 1, FREQ.size)
    return level * (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)


def test_a_peak_is_found_with_place_height_and_width():
    values = receptance(192.5, 0.001) + noise(np.random.default_rng(1), 1e-4)
    (peak,) = standing_peaks(FREQ, values)
    assert peak.f_hz == pytest.approx(192.5, abs=0.3125)
    # The power of a resonance halves at its half bandwidth, 0.19 Hz; lines are 0.31 Hz apart.
    assert peak.half_width_hz == pytest.approx(0.19, abs=0.32)
    assert peak.height > 20.0  # over the flanks, 40 lines to either side
    (pole,) = peak_poles([peak])
    assert pole.imag == 2.0 * np.pi * peak.f_hz


def test_noise_and_what_rises_to_the_edge_have_none():
    values = noise(np.random.default_rng(2), 1.0)
    assert standing_peaks(FREQ, values) == ()
    assert standing_peaks(FREQ, values + receptance(600.0, 0.01, scale=1e4)) == ()


def test_only_a_pole_within_reach_explains_a_peak():
    peak = Peak(f_hz=100.0, height=50.0, half_width_hz=0.5)
    near, far = (2.0 * np.pi * np.array([-0.5 + 1j * f]) for f in (100.9, 103.0))
    assert unexplained([peak], near, 0.3) == ()
    assert unexplained([peak], far, 0.3) == (peak,)
    assert unexplained([peak], np.empty(0, dtype=complex), 0.3) == (peak,)


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(i, marks=pytest.mark.long) for i in range(1, 4))]
)
def test_a_peak_three_lines_wide_in_noise_that_grows_with_it_is_a_mode(seed):
    """Few averages of a shaken structure: half of every line is scatter."""
    rng = np.random.default_rng(seed)
    clean = receptance(192.6, 0.002)
    values = clean * (1.0 + noise(rng, 0.5)) + noise(rng, 1e-3 * np.abs(clean).max())
    for band in (None, (150.0, 250.0), (50.0, 400.0)):
        model = fit_modes(record(values, FREQ, form=FrfForm.RECEPTANCE), band_hz=band)
        near = np.abs(model.f_hz - 192.6)
        assert near.size
        # One response, so no scatter between points: Student's t of few degrees of freedom.
        assert near.min() < 4.0 * model.modes[int(np.argmin(near))].f_std_hz


def test_a_line_of_the_mains_is_told_and_is_no_mode():
    values = receptance(80.0, 0.01) + noise(np.random.default_rng(3), 1e-4)
    values[..., 800] += 3.0  # one line
    model = fit_modes(record(values, FREQ, form=FrfForm.RECEPTANCE))
    assert model.f_hz[0] == pytest.approx(80.0, abs=0.05)
    single = [f for f in model.f_hz if abs(f - FREQ[800]) < 1.0]
    assert single or any(f"{FREQ[800]:.5g} Hz" in note for note in model.notes)
