import numpy as np
import pytest

from armodal.analyzer.modal.noise import (
    hit_scatter_variance,
    independent_line_share,
    line_to_line_noise,
    smooth_lines,
)
from armodal.analyzer.modal.windows import (
    exponential_decay,
    exponential_window,
    force_window,
    undo_highpass,
)
from armodal.protocols.errors import EstimateError


def test_exponential_falls_to_its_end_value_over_the_record():
    decay = exponential_decay(0.03, 2.0)
    window = exponential_window(2001, 1000.0, decay)
    assert window[0] == 1.0
    assert window[-1] == pytest.approx(0.03)


@pytest.mark.parametrize("end", [0.0, -1.0, 1.5, float("nan")])
def test_impossible_window_ends_are_refused(end):
    with pytest.raises(EstimateError, match="exponential_end"):
        exponential_decay(end, 1.0)


def test_force_window_keeps_the_pulse_and_ends_at_its_length():
    window = force_window(2000, 1000.0, 100, 0.4)
    assert np.all(window[:450] == 1.0)
    assert np.all(window[500:] == 0.0)
    assert np.all(np.diff(window) <= 0.0)


def test_undoing_the_coupling_restores_a_step():
    rate, corner = 10_000.0, 0.5
    t = np.arange(5000) / rate
    coupled = np.exp(-2.0 * np.pi * corner * t)  # the step response of s/(s + wc)
    # Trapezoidal rule: (wc dt)^2 / 12.
    np.testing.assert_allclose(undo_highpass(coupled, rate, corner), 1.0, atol=1e-6)


def test_independent_share_is_that_of_windowed_noise():
    rng = np.random.default_rng(0)
    n, end = 256, 0.03
    window = exponential_window(n, 1.0, exponential_decay(end, float(n)))
    spectra = np.fft.rfft(window * rng.standard_normal((4000, n)))[:, 10:110]
    power = np.abs(spectra) ** 2
    means = power.mean(axis=1)
    # Variance of a mean of N exponential variables is mean^2 / (N share); ends of the hundred
    # lines and 4000 draws leave some 5 %.
    share = power.mean() ** 2 / (means.var() * 100)
    decay = exponential_decay(end, float(n))
    assert independent_line_share(decay, 1.0 / n) == pytest.approx(share, rel=0.1)


def test_smoothing_keeps_a_constant_and_the_mean_of_a_line():
    np.testing.assert_allclose(smooth_lines(np.full((2, 20), 3.0), 4), 3.0)
    spike = np.zeros(21)
    spike[10] = 9.0
    np.testing.assert_allclose(smooth_lines(spike, 4)[6:15], 1.0)


@pytest.mark.parametrize("end", [1.0, 0.2])
def test_what_differs_from_line_to_line_is_the_noise_beside_resonances(end):
    rng = np.random.default_rng(5)
    n, rate = 8192, 512.0
    decay = exponential_decay(end, n / rate)
    window = exponential_window(n, rate, decay)
    freq = np.fft.rfftfreq(n, 1.0 / rate)
    noise = np.fft.rfft(rng.standard_normal((8, n)) * window)
    s = decay + 2j * np.pi * freq
    pole = 2.0 * np.pi * 60.0 * (-0.002 + 1j)
    resonance = 2e6 / ((s - pole) * (s - pole.conjugate()))
    assert np.abs(resonance).max() ** 2 > 1e2 * n
    level = line_to_line_noise(noise + resonance, decay, rate / n)
    # A median of 41 correlated lines scatters by some 25 %, that of eight of them by 9 %.
    expected = np.sum(window**2)
    assert np.median(level.mean(axis=0)) == pytest.approx(expected, rel=0.1)
    assert level.mean(axis=0).max() < 2.0 * expected


def test_lines_alike_through_a_short_window_tell_no_noise():
    values = np.ones((1, 100), dtype=complex)
    assert not np.any(line_to_line_noise(values, 20.0, 1.0))
    assert not np.any(line_to_line_noise(values[:, :20], 0.0, 1.0))


LINES = np.arange(1, 401)


def told_over_true(noise, seed=5):
    """(2, n_lines) variance told of three hits over the true one, where a white floor of 1 is told.

    Means over 40 FRFs whose hits scatter by 1 % of an answer far above the noise, and over 20
    without an answer.
    """
    rng = np.random.default_rng(seed)
    answers = (np.arange(60) < 40)[:, None, None]
    magnitude_squared = np.where(answers, 1e8, noise)
    true = noise + 1e-4 * magnitude_squared
    normal = rng.standard_normal((4, *true.shape))  # two complex degrees of freedom
    told = hit_scatter_variance(
        true * np.mean(normal**2, axis=0),
        np.ones(true.shape),
        magnitude_squared,
        np.full(true.shape[:2], 3),
        1.0,
    )
    ratio = (told / true)[:, 0]
    return ratio[:40].mean(axis=0), ratio[40:].mean(axis=0)


def test_noise_that_rises_towards_low_frequencies_has_its_own_variance():
    # Ten times the white floor at line 20; from there on the nine lines that are smoothed hardly
    # bend it. Twenty FRFs of nine lines scatter by 5 %. A variance is never below the floor: what
    # scatters below it is taken for it, up to a quarter too much of a silent FRF.
    answering, silent = told_over_true(1.0 + 9.0 * 20.0 / LINES)
    assert silent[19:] == pytest.approx(np.ones(len(LINES) - 19), abs=0.25)
    assert answering[19:] == pytest.approx(np.ones(len(LINES) - 19), abs=0.2)


def test_white_noise_is_told_as_white():
    answering, silent = told_over_true(np.ones(len(LINES)))
    assert silent.min() >= 1.0
    assert silent.max() < 1.25
    assert answering == pytest.approx(np.ones(len(LINES)), abs=0.2)
