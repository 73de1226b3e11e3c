from __future__ import annotations

import numpy as np
import pytest

from armodal.daq.clock_fit import ClockTracker, RoundTrip, fit_clock

TICK_HZ = 1_000_000
FAR = 2**63  # ticks where a float's step is 2048 ticks, 2 ms


def trip(device_s: float, way_out_s: float, way_back_s: float, *, ppm: float = 0.0) -> RoundTrip:
    ticks = FAR + round(device_s * TICK_HZ * (1.0 + 1e-6 * ppm))
    return RoundTrip(
        sent_s=100.0 + device_s - way_out_s, received_s=100.0 + device_s + way_back_s, ticks=ticks
    )


def test_symmetric_trips_give_host_time_to_rounding_even_at_64_bit_ticks():
    fit = fit_clock(
        [trip(t, 1e-3, 1e-3, ppm=50.0) for t in np.linspace(0.0, 10.0, 40)],
        nominal_tick_hz=TICK_HZ,
    )
    ticks = FAR + round(5.0 * TICK_HZ * (1.0 + 50e-6))
    # Ticks are whole microseconds: each middle is rounded by at most half of one.
    assert fit.host_s(ticks) == pytest.approx(105.0, abs=1e-6)


def test_slow_trips_do_not_disturb_the_fit():
    rng = np.random.default_rng(7)
    times = np.linspace(0.0, 60.0, 300)
    trips = []
    for t in times:
        slow = rng.random() < 0.6
        trips.append(trip(t, 2e-4 + (rng.exponential(0.02) if slow else 0.0), 2e-4))
    fit = fit_clock(trips, nominal_tick_hz=TICK_HZ)
    # 40 % of the trips are exact to a tick; the fastest 20 % are all among them.
    assert fit.host_s(FAR + 30 * TICK_HZ) == pytest.approx(130.0, abs=2e-6)
    assert fit.s_per_tick * TICK_HZ == pytest.approx(1.0, abs=1e-6)


def test_the_true_time_lies_within_the_uncertainty_when_one_way_is_slow():
    # All the delay on the way out: the worst split, half a trip off, sqrt(3) sigma of a uniform.
    trips = [trip(t, 1e-3, 0.0) for t in np.linspace(0.0, 5.0, 50)]
    fit = fit_clock(trips, nominal_tick_hz=TICK_HZ)
    error_s = abs(fit.host_s(FAR + 2 * TICK_HZ) - 102.0)
    # Ticks are whole microseconds, so a middle may be half of one further off.
    assert error_s <= np.sqrt(3.0) * fit.uncertainty_s(FAR + 2 * TICK_HZ) + 0.5 / TICK_HZ


def test_a_quiet_moment_does_not_stand_for_the_whole_session():
    rng = np.random.default_rng(8)
    quiet = [trip(1e-3 * k, 1e-4 * rng.random(), 1e-4 * rng.random()) for k in range(40)]
    late = [trip(0.5 * k, 1e-3 + 1e-3 * rng.random(), 1e-3) for k in range(1, 81)]
    fit = fit_clock([*quiet, *late], nominal_tick_hz=TICK_HZ)
    end = FAR + 40 * TICK_HZ
    # Trips of 2 to 2.3 ms: the standard deviation of a uniform of that width is below 0.7 ms.
    assert abs(fit.host_s(end) - 140.0) < 3.0 * fit.uncertainty_s(end) < 3.0 * 0.7e-3


def test_a_single_trip_uses_the_rate_the_device_declares():
    fit = fit_clock([trip(0.0, 1e-3, 1e-3)], nominal_tick_hz=TICK_HZ)
    assert fit.host_s(FAR + TICK_HZ) == pytest.approx(101.0, abs=1e-9)


def test_no_trip_is_no_clock():
    with pytest.raises(ValueError, match="at least one round trip"):
        fit_clock([], nominal_tick_hz=TICK_HZ)


def test_the_tracker_forgets_the_oldest_trips():
    tracker = ClockTracker(TICK_HZ, keep=10)
    for t in range(30):
        tracker.add(trip(float(t), 1e-3, 1e-3))
    assert len(tracker) == 10
    assert tracker.fit().host_s(FAR) == pytest.approx(100.0, abs=1e-6)


def steady_trips(n, jump_after=None, jump_ticks=0, every_s=0.5, duration_s=0.002):
    trips = []
    for i in range(n):
        at_s = every_s * i
        ticks = round(TICK_HZ * (at_s + duration_s / 2.0))
        if jump_after is not None and i >= jump_after:
            ticks += jump_ticks
        trips.append(RoundTrip(sent_s=at_s, received_s=at_s + duration_s, ticks=ticks))
    return trips


@pytest.mark.parametrize("jump_s", [-3.0, -0.02, 0.02, 3.0])
def test_a_jump_of_the_device_s_clock_is_noticed_and_the_earlier_trips_forgotten(jump_s):
    tracker = ClockTracker(TICK_HZ)
    jumped = [tracker.add(t) for t in steady_trips(60, 40, round(jump_s * TICK_HZ))]
    assert jumped == [i == 40 for i in range(60)]
    ticks = round(TICK_HZ * (29.6 + jump_s))
    # A trip lasts 2 ms, and its middle is known to be the reading here.
    assert tracker.fit().host_s(ticks) == pytest.approx(29.6, abs=1e-4)


def test_a_slow_trip_is_neither_a_jump_nor_believed():
    tracker = ClockTracker(TICK_HZ)
    for trip in steady_trips(40):
        tracker.add(trip)
    # Held up for a second and a half on the way back: its middle is 0.75 s off.
    assert not tracker.add(RoundTrip(sent_s=20.0, received_s=21.5, ticks=round(TICK_HZ * 20.001)))
    assert tracker.fit().host_s(TICK_HZ * 20) == pytest.approx(20.0, abs=1e-3)
