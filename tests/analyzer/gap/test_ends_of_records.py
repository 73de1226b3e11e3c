"""Noise of records with one hit a point, from their ends."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from armodal.analyzer.gap.model.ends_of_records import noise_at_ends, windowed_noise_power
from armodal.analyzer.modal.spectra import active_channels

RATE_HZ, N = 2000.0, 2000
S = 2.0 * np.pi * (6.0 + 1j * np.array([5.0, 20.0, 100.0]))


def test_slow_noise_has_the_power_on_lines_that_windowed_records_of_it_have():
    random = np.random.default_rng(1)
    fresh = random.standard_normal((4000, 2 * N))
    noise = lfilter([1.0], [1.0, -0.95], fresh, axis=1)[:, N:]  # a third of it is below 16 Hz
    waves = np.exp(-np.outer(np.arange(N) / RATE_HZ, S)) / RATE_HZ
    measured = np.mean(np.abs(noise @ waves) ** 2, axis=0)
    told = np.mean(windowed_noise_power(noise, RATE_HZ, S), axis=0)
    # Squares of 4000 complex numbers scatter by 1.6 %: three of that.
    np.testing.assert_allclose(told, measured, rtol=0.05)


@pytest.fixture(scope="module")
def quiet(session):
    """A hit whose record has noise of 100 counts in every sensor from its middle on."""
    hit = session.hits[0]
    random = np.random.default_rng(2)
    columns = active_channels(session)[2]
    counts = hit.counts.copy()
    counts[:, columns[1:]] = 0
    half = len(counts) // 2
    noise = np.rint(100.0 * random.standard_normal((len(counts) - half, 3)))
    counts[half:, columns[1:]] = noise.astype(counts.dtype)
    return replace(hit, counts=counts)


def test_what_ends_of_records_hold_goes_into_the_accelerances(session, quiet):
    force, channels, columns = active_channels(session)
    rate = float(session.header.plan.sampling.rate_hz)
    found = noise_at_ends(session, [quiet], S)[0]
    scale = np.array([channel.scale for channel in channels])
    n = len(quiet.counts)
    power = np.sum(np.exp(-2.0 * S[0].real * np.arange(n - n // 2) / rate)) / rate**2
    pushes = force.scale * quiet.counts[:, columns[0]].astype(float)
    pushes -= pushes[: quiet.trigger_sample - quiet.first_sample - 2].mean()
    of_force = pushes[: n // 2] @ np.exp(-np.outer(np.arange(n // 2) / rate, S)) / rate
    expected = (100.0 * scale[:, None]) ** 2 * power / np.abs(of_force) ** 2
    # One record's lines are as noisy as noise is: 18 of them, each within a factor of eight.
    assert np.all(found < 8.0 * expected)
    assert np.mean(found / expected) == pytest.approx(1.0, abs=0.7)
