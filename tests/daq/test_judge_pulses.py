from __future__ import annotations

import numpy as np
import pytest

from armodal.daq.judge_anti_alias import without_narrow_pulse
from armodal.daq.judge_disturbance import without_disturbance, without_undershoot
from armodal.daq.judge_pulses import find_pulses

RATE_HZ = 5000.0
N = 2000
T = np.arange(N) / RATE_HZ


def half_sine(at_s, width_s, peak_n=100.0):
    x = np.clip((T - at_s) / width_s, 0.0, 1.0)
    return peak_n * np.sin(np.pi * x)


def found_in(force, **changes):
    limits = {"highpass_hz": 0.0, "double": 0.06, "noise": 6.0, "contact": 0.25}
    return find_pulses(force, RATE_HZ, **(limits | changes))


def test_a_lone_pulse_has_no_other():
    pulses = found_in(half_sine(0.05, 4e-3))
    assert pulses.others == ()
    assert pulses.peak_n == pytest.approx(100.0, rel=1e-2)
    # Two thirds of a half-sine's width lie above half its peak; half a sample of reading.
    assert pulses.half_width == pytest.approx(2.0 / 3.0 * 4e-3 * RATE_HZ, abs=0.5)


@pytest.mark.parametrize("width_s", [0.5e-3, 2e-3, 8e-3])
@pytest.mark.parametrize("share", [0.2, 0.8, 1.0, 3.0])
def test_another_pulse_is_found_where_it_is_whichever_is_higher(width_s, share):
    force = half_sine(0.05, width_s) + share * half_sine(0.1, width_s)
    other = found_in(force).others
    assert len(other) == 1
    assert other[0].released
    lower_at_s = (0.05 if share > 1.0 else 0.1) + 0.5 * width_s
    higher_at_s = (0.1 if share > 1.0 else 0.05) + 0.5 * width_s
    off = min(abs(other[0].at / RATE_HZ - at) for at in (lower_at_s, higher_at_s))
    assert off <= 1.0 / RATE_HZ  # one sample
    if share != 1.0:
        assert other[0].at / RATE_HZ == pytest.approx(lower_at_s, abs=1.0 / RATE_HZ)
        # Pulses of two and a half samples lose up to half their height between samples.
        assert other[0].share == pytest.approx(min(share, 1.0 / share), rel=0.5)


def test_pulses_between_which_the_force_never_falls_are_not_released():
    force = half_sine(0.05, 6e-3) + 0.7 * half_sine(0.0545, 6e-3)
    other = found_in(force).others
    assert [o.released for o in other] == [False]


def test_noise_is_no_pulse_and_says_what_it_hides():
    rng = np.random.default_rng(1)
    force = half_sine(0.05, 1e-3) + 4.0 * rng.standard_normal(N)
    pulses = found_in(force)
    assert pulses.others == ()
    # Relative standard error of a standard deviation from the median of N values: 1.17/sqrt(N).
    assert pulses.noise_n == pytest.approx(4.0, rel=4 * 1.17 / np.sqrt(N))
    # White noise behind (1, 4, 6, 4, 1)/16 keeps sqrt(70)/16 of its deviation; the smoothed
    # pulse loses some of its height, a quarter at this width.
    assert 6 * 0.04 * np.sqrt(70) / 16 < pulses.hidden < 6 * 0.04 * np.sqrt(70) / 16 / 0.7


def test_hum_of_a_tenth_is_no_pulse_and_hides_none():
    hum = 10.0 * np.sin(2 * np.pi * 50.0 * T + 1.0) + 3.0 * np.sin(2 * np.pi * 150.0 * T)
    assert found_in(half_sine(0.05, 8e-3) + hum).others == ()
    assert len(found_in(half_sine(0.05, 8e-3) + 0.15 * half_sine(0.09, 8e-3) + hum).others) == 1


@pytest.mark.parametrize("mains_hz", [50.0, 60.0])
def test_hum_and_line_are_taken_off_exactly(mains_hz):
    disturbance = 2.0 + 3.0 * T + 5.0 * np.cos(2 * np.pi * mains_hz * T + 0.3)
    quiet = np.abs(T - 0.05) > 0.01
    left = without_disturbance(half_sine(0.049, 2e-3) + disturbance, RATE_HZ, quiet)
    # Least squares on exact data: rounding of some 1e-13 of the values.
    np.testing.assert_allclose(left, half_sine(0.049, 2e-3), atol=1e-9)


def test_a_record_of_less_than_three_periods_keeps_its_hum():
    force = np.sin(2 * np.pi * 50.0 * T[:250])
    assert without_disturbance(force, RATE_HZ, np.ones(250, dtype=bool)) is force


def test_undershoot_of_known_coupling_is_undone():
    corner_hz = 4.0
    # Closed form: a step held for w behind s/(s + wc) is exp(-wc t), then minus the same from w on.
    wc, begin, w = 2 * np.pi * corner_hz, 0.05, 8e-3
    after = T - begin
    box = np.where(after >= 0.0, np.exp(-wc * after), 0.0)
    box = box - np.where(after >= w, np.exp(-wc * (after - w)), 0.0)
    undone = without_undershoot(box, RATE_HZ, corner_hz)
    late = after > w + 1.0 / RATE_HZ
    # The rectangle rule errs by half a sample of force at either edge: wc / rate.
    np.testing.assert_allclose(undone[late], 0.0, atol=1.1 * wc / RATE_HZ)
    assert box[late].min() < -0.15


def test_the_lobes_of_a_sharp_filter_go_with_the_template():
    # An impulse half-way between two samples behind an ideal low-pass at 0.46 of the rate.
    at = 500.4
    n = np.arange(N) - at
    force = np.sinc(2 * 0.46 * n)
    force *= np.hanning(61)[np.clip(np.round(n).astype(int) + 30, 0, 60)]
    left = without_narrow_pulse(force, int(np.argmax(force)))
    lobes = np.abs(force[506:530]).max()
    # Bank cut-offs lie 0.04 apart: the nearest template's lobes differ by a good part.
    assert np.abs(left[506:530]).max() < 0.6 * lobes
