from dataclasses import replace

import numpy as np
import pytest
from support.several_references import several_references
from support.simulated_frfs import eight_modes

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.band import carried_band, lines_within, proposed_band
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfForm


def fading(*, told):
    """FRFs whose force falls with frequency, so that noise rises; and where both are alike."""
    frf = eight_modes(np.random.default_rng(0), form=FrfForm.ACCELERANCE, top_hz=400.0).frf
    rng = np.random.default_rng(1)
    sigma = 0.01 * np.sqrt(np.mean(np.abs(frf.values) ** 2)) * np.exp((frf.freq_hz / 60.0) ** 2)
    noise = rng.standard_normal((2, *frf.values.shape)) / np.sqrt(2.0)
    values = frf.values + sigma * (noise[0] + 1j * noise[1])
    variance = np.broadcast_to(sigma**2 if told else 0.0, values.shape)
    power = np.mean(np.abs(frf.values) ** 2, axis=(0, 1))
    last = float(frf.freq_hz[np.flatnonzero(power > sigma**2)[-1]])
    return replace(frf, values=values, variance=variance), last


@pytest.mark.parametrize("told", [pytest.param(True, marks=pytest.mark.long), False])
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


def test_where_no_band_is_asked_for_what_is_left_out_is_said_end_by_end():
    frf, _ = fading(told=True)
    band, (said,) = proposed_band(frf)
    assert band == carried_band(frf)
    assert f"lines above {band[1]:.5g} Hz are noise" in said
    assert "below" not in said
    assert proposed_band(eight_modes(np.random.default_rng(1)).frf)[0][0] == frf.freq_hz[0]
    assert proposed_band(several_references(np.random.default_rng(0)).frf) == (None, ())


def test_lines_of_a_band_keep_all_that_is_known_of_them():
    frf = several_references(np.random.default_rng(0)).frf
    low, high = float(frf.freq_hz[20]), float(frf.freq_hz[60])
    cut = lines_within(frf, (low, high))
    for name in ("values", "variance", "coherence"):
        kept, whole = getattr(cut, name), getattr(frf, name)
        assert np.array_equal(kept, whole[..., 20:61], equal_nan=True)
    assert np.array_equal(cut.freq_hz, frf.freq_hz[20:61])
    assert (cut.responses, cut.references) == (frf.responses, frf.references)
    with pytest.raises(EstimateError, match=r"holds 7 of .* widen it"):
        lines_within(frf, (low, float(frf.freq_hz[26])))


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
