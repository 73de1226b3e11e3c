"""A long record is searched span by span, and holds the modes that one piece would."""

import numpy as np
from support.simulated_frfs import noisy_record

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.spans import LINES, spans
from armodal.protocols.frf_records import FrfForm


def long_record(rng, n_modes, n_freq):
    freq = np.arange(1, n_freq + 1) * 0.2
    f = np.linspace(0.03, 0.97, n_modes) * freq[-1] * (1.0 + 0.003 * rng.uniform(-1, 1, n_modes))
    damping = rng.uniform(1e-3, 3e-3, n_modes)
    poles = 2.0 * np.pi * f * (-damping + 1j * np.sqrt(1.0 - damping**2))
    s = 2j * np.pi * freq
    shape = rng.normal(size=(4, n_modes)) * poles.imag / 1j
    values = shape @ (1.0 / (s - poles[:, None])) + shape.conj() @ (
        1.0 / (s - poles.conj()[:, None])
    )
    frf = noisy_record(rng, values[:, None, :], freq, form=FrfForm.ACCELERANCE, level=0.01)
    return frf, f


def test_spans_cover_all_lines_and_share_none_of_their_own():
    frf, _ = long_record(np.random.default_rng(1), 12, 3 * LINES)
    found = spans(frf.freq_hz, frf.values, frf.variance)
    assert len(found) == 3
    assert found[0].first == 0
    assert found[-1].last == frf.freq_hz.size - 1
    holders = np.sum([span.holds(frf.freq_hz) for span in found], axis=0)
    assert np.all(holders == 1)
    for span in found:
        own = np.flatnonzero(span.holds(frf.freq_hz))
        assert span.first <= own[0]
        assert own[-1] <= span.last


def test_all_modes_of_a_long_record_are_found_and_none_twice():
    frf, f = long_record(np.random.default_rng(2), 12, 2 * LINES)
    model = fit_modes(frf)
    assert len(model.modes) == f.size
    std = np.array([mode.f_std_hz for mode in model.modes])
    assert np.all(np.abs(model.f_hz - f) < 5.0 * std)  # twelve modes: one in a million is beyond
