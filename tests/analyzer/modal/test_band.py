from dataclasses import replace

import numpy as np
import pytest
from support.several_references import several_references
from support.simulated_frfs import eight_modes

from armodal.analyzer.modal import carried_band, fit_modes
from armodal.protocols.frf_records import FrfForm


def fading(*, told):
    """FRFs whose force falls with frequency, so that noise rises; and where both are alike."""
    frf = eight_modes(np.random.default_rng(0), form=FrfForm.ACCELERANCE).frf
    rng = np.random.default_rng(1)
    sigma = 0.01 * np.sqrt(np.mean(np.abs(frf.values) ** 2)) * np.exp((frf.freq_hz / 60.0) ** 2)
    noise = rng.standard_normal((2, *frf.values.shape)) / np.sqrt(2.0)
    values = frf.values + sigma * (noise[0] + 1j * noise[1])
    variance = np.broadcast_to(sigma**2 if told else 0.0, values.shape)
    power = np.mean(np.abs(frf.values) ** 2, axis=(0, 1))
    last = float(frf.freq_hz[np.flatnonzero(power > sigma**2)[-1]])
    return replace(frf, values=values, variance=variance), last


@pytest.mark.parametrize("told", [True, False])
def test_the_band_ends_where_noise_is_as_large_as_the_frfs(told):
    frf, last = fading(told=told)
    low, high = carried_band(frf)
    # FRFs weigh alike in the band and by their power in the truth; noise doubles in 5 Hz there.
    assert high == pytest.approx(last, abs=10.0)
    assert low < 9.0
    model = fit_modes(frf, band_hz=(low, high))
    # Every mode that can be seen: the last three lie where noise is over a third of the FRFs.
    assert np.sum(model.f_hz < 60.0) == 6


def test_frfs_that_carry_a_signal_throughout_are_left_whole():
    assert carried_band(several_references(np.random.default_rng(0)).frf) is None
    frf = eight_modes(np.random.default_rng(1), form=FrfForm.ACCELERANCE).frf
    assert carried_band(frf) is None
    assert carried_band(replace(frf, variance=np.zeros(frf.variance.shape))) is None


def test_a_sharp_peak_is_a_signal_wherever_it_stands():
    frf, last = fading(told=False)
    values = frf.values.copy()
    line = int(np.argmin(np.abs(frf.freq_hz - 300.0)))
    assert frf.freq_hz[line] > last
    values[..., line - 1 : line + 2] *= 100.0
    assert carried_band(replace(frf, values=values))[1] >= 300.0


def test_a_fit_tells_what_it_does():
    heard = []
    fit_modes(several_references(np.random.default_rng(0)).frf, tell=heard.append)
    assert heard == [
        "poles over model orders",
        "which poles the FRFs need",
        "whether 4 modes move, and where they are",
    ]
