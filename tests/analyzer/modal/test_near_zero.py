"""Lines near 0 Hz that a filter has cut away."""

import numpy as np
import pytest
from support.simulated_frfs import modal_frf, poles_of, record

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.near_zero import first_line
from armodal.protocols.frf_records import FrfForm

FREQ = 0.25 * np.arange(1, 1601)
F_HZ = np.array([60.0, 151.0, 287.0])


def free_body(rng, f_hz=F_HZ, damping=0.01):
    """Accelerances of a free body at six points: 1/m below its modes."""
    poles = poles_of(f_hz, np.full(f_hz.size, damping))
    shapes = rng.standard_normal((f_hz.size, 6, 1)) / (2j * poles.imag[:, None, None])
    return 0.3 + modal_frf(poles, shapes, FREQ, FrfForm.ACCELERANCE)


def filtered(values, cut_hz, order):
    """Behind a Butterworth high-pass of an even order."""
    s = 1j * FREQ / cut_hz
    angles = np.pi * (2 * np.arange(order) + order + 1) / (2 * order)
    return values * s**order / np.prod([s - np.exp(1j * angle) for angle in angles], axis=0)


def told(rng, values, floor=1e-5, share=0.005):
    """With noise, and a variance that a coherence would tell: in proportion to what is left."""
    sigma = np.sqrt(floor**2 + (share * np.abs(values)) ** 2)
    noise = (rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape)) / np.sqrt(2.0)
    return record(values + sigma * noise, FREQ, variance=sigma**2)


@pytest.mark.parametrize("order", [4, 8])
def test_what_a_filter_cut_away_is_left_out_and_said(order):
    rng = np.random.default_rng(order)
    model = fit_modes(told(rng, filtered(free_body(rng), 8.0, order)))
    assert any("a filter" in note for note in model.notes)
    # From twice the cut-off a filter of second order has 3 % left, of these orders less.
    assert 8.0 < model.band_hz[0] < 25.0
    assert len(model.modes) == F_HZ.size
    for mode, f_hz in zip(model.modes, F_HZ, strict=True):
        # Student's t of the few degrees of freedom, 1e-3: six deviations.
        assert abs(mode.f_hz - f_hz) < 6.0 * mode.f_std_hz
        # What such a filter still turns the phase by at 60 Hz is told to be there.
        assert mode.f_std_hz < 0.2 * mode.damping_ratio * mode.f_hz


@pytest.mark.parametrize("f_hz", [3.0, 10.0, 40.0])
@pytest.mark.parametrize("damping", [0.001, 0.05])
@pytest.mark.parametrize("form", FrfForm)
def test_no_first_resonance_is_taken_for_a_filter(f_hz, damping, form):
    rng = np.random.default_rng(3)
    poles = poles_of(f_hz * np.array([1.0, 2.7, 5.1]), np.full(3, damping))
    shapes = rng.standard_normal((3, 6, 1)) / (2j * poles.imag[:, None, None])
    values = modal_frf(poles, shapes, FREQ, form)
    assert first_line(record(values, FREQ, form=form), told=True)[0] == 0
