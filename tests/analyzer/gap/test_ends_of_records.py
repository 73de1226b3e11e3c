"""Noise of records with one hit a point, from their ends."""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.ends_of_records import noise_at_ends, windowed_noise_power
from armodal.analyzer.gap.model.hit_levels import postures_hit_once
from armodal.analyzer.gap.model.lines import Annealing, own_lines
from armodal.analyzer.modal.spectra import active_channels
from armodal.analyzer.modal.windows import highpass_response

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


def with_noise(session, seed):
    """Its first hit, with nothing in any sensor but noise of 100 counts from the middle on."""
    hit = session.hits[0]
    columns = active_channels(session)[2]
    counts = hit.counts.copy()
    counts[:, columns[1:]] = 0
    half = len(counts) // 2
    noise = 100.0 * np.random.default_rng(seed).standard_normal((len(counts) - half, 3))
    counts[half:, columns[1:]] = np.rint(noise).astype(counts.dtype)
    return replace(hit, counts=counts)


def test_what_ends_of_records_hold_goes_into_the_accelerances(session):
    force, channels, columns = active_channels(session)
    rate = float(session.header.plan.sampling.rate_hz)
    found = noise_at_ends(session, [with_noise(session, seed) for seed in range(200)], S)
    hit, scale = session.hits[0], np.array([channel.scale for channel in channels])
    n = len(hit.counts)
    power = np.sum(np.exp(-2.0 * S[0].real * np.arange(n - n // 2) / rate)) / rate**2
    pushes = force.scale * hit.counts[:, columns[0]].astype(float)
    pushes -= pushes[: hit.trigger_sample - hit.first_sample - 2].mean()
    of_force = pushes[: n // 2] @ np.exp(-np.outer(np.arange(n // 2) / rate, S)) / rate
    high = np.array([highpass_response(S, channel.highpass_hz) for channel in channels])
    expected = (100.0 * scale[:, None]) ** 2 * power / np.abs(of_force * high) ** 2
    # 200 records scatter by some 7 % on the lowest line: four of that.
    np.testing.assert_allclose(found.mean(axis=0), expected, rtol=0.3)


def with_loud_end(session, hit):
    """The hit with a hum of 30 Hz in its last quarter, as large as its answer."""
    counts, columns = hit.counts.copy(), active_channels(session)[2][1:]
    n = len(counts) // 4
    t = np.arange(n) / float(session.header.plan.sampling.rate_hz)
    hum = np.outer(np.sin(2.0 * np.pi * 30.0 * t), np.ptp(counts[:, columns], axis=0))
    counts[-n:, columns] += np.rint(hum).astype(counts.dtype)
    return replace(hit, counts=counts)


def test_only_single_hits_have_the_noise_of_their_ends(session):
    """In a posture where one point is hit several times, and the others once."""
    superset = Superset(session.header.arm)
    stage = Annealing(sigma_rad_s=2 * np.pi * 6.0, step_hz=8.0, band_hz=(8.0, 60.0))
    posture = session.hits[0].posture
    of_posture = [hit for hit in session.hits if hit.posture == posture and hit.verdict.accepted]
    points = list(dict.fromkeys(hit.sensor_point for hit in of_posture))
    first = {hit.sensor_point: hit for hit in reversed(of_posture)}
    several = [hit for hit in of_posture if hit.sensor_point == points[0]]
    assert len(several) > 1
    mostly = replace(session, hits=(*several, *(first[point] for point in points[1:])))
    assert postures_hit_once(mostly.hits) == (posture,)
    assert postures_hit_once(of_posture) == ()
    (found,) = own_lines(superset, mostly, stage)
    # The same with a record's end that is much louder: only what was hit once takes it for noise.
    loud = [with_loud_end(session, hit) for hit in mostly.hits]
    (louder,) = own_lines(superset, replace(mostly, hits=tuple(loud)), stage)
    ratio = np.median(louder.variance / found.variance, axis=(1, 2))
    ids = [point.id for point in superset.arm.points]
    once = np.array([ids[point] != points[0] for point in found.sensor_point])
    assert np.all(ratio[once] > 2.0)
    # Three quarters into a record next to nothing passes the window.
    np.testing.assert_allclose(ratio[~once], 1.0, rtol=0.01)


def test_hits_along_two_directions_are_two_points_hit_once(session):
    one = session.hits[0]
    other = replace(one, hit_direction=np.roll(one.hit_direction, 1))
    assert postures_hit_once([one, other]) == (one.posture,)
    assert postures_hit_once([one, one, other]) == ()
