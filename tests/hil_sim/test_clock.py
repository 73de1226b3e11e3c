from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.hil_sim.clock import DeviceClock, LabClock, SampleClock


@pytest.mark.parametrize("scale", [0.0, -1.0, float("inf"), float("nan")])
def test_a_clock_that_does_not_run_is_refused(scale):
    with pytest.raises(ValueError, match="positive"):
        LabClock(scale=scale)


def test_device_ticks_gain_their_ppm():
    lab = LabClock(monotonic=lambda: 0.0)
    clock = DeviceClock(lab=lab, boot_s=10.0, error_ppm=100.0, offset_ticks=7)
    # One tick: truncation.
    assert clock.ticks_at(1010.0) - 7 == pytest.approx(1000 * 1_000_100, abs=1)


def test_device_ticks_do_not_run_before_boot():
    clock = DeviceClock(lab=LabClock(), boot_s=10.0, offset_ticks=7)
    assert clock.ticks_at(9.0) == 7


@given(
    divisor=st.integers(1, 512),
    tick_hz=st.sampled_from([1_000_000, 84_000_000]),
    start=st.integers(0, 1 << 40),
    sample=st.integers(0, 1 << 40),
)
def test_a_sample_is_due_at_its_ready_tick_and_not_before(divisor, tick_hz, start, sample):
    clock = SampleClock(rate_hz=Fraction(51_200, divisor), tick_hz=tick_hz, start_ticks=start)
    ready = clock.ready_ticks(sample)
    assert clock.due(ready) == sample + 1
    assert clock.due(ready - 1) == sample


def test_nothing_is_due_before_start():
    clock = SampleClock(rate_hz=Fraction(1000), tick_hz=1_000_000, start_ticks=100)
    assert clock.due(99) == 0
