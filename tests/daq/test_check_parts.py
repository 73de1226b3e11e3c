"""The parts of the checks that need no device."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.daq.check.board_run import check_clock
from armodal.daq.check.raw_frame import RawDecoder, encode_raw
from armodal.daq.check.run import run_steps
from armodal.daq.check.stream import record
from armodal.daq.check.tick_rate import tick_rate
from armodal.daq.check.trigger_truth import expected_blocks
from armodal.daq.check.verdict import Report, Step, Verdict, failed, passed, unchecked
from armodal.daq.clock_fit import RoundTrip
from armodal.protocols.board.records import Slope
from armodal.protocols.errors import DeviceLostError, FrameError


@given(
    kind=st.integers(0, 255),
    version=st.integers(0, 255),
    payload=st.binary(max_size=2048),
    cut=st.integers(0, 40),
)
def test_a_frame_of_any_type_and_version_comes_back(kind, version, payload, cut):
    wire = encode_raw(kind, payload, session=7, sequence=8, tag=9, version=version)
    decoder = RawDecoder()
    frames = decoder.feed(wire[:cut], 1.0) + decoder.feed(wire[cut:], 2.0)
    (frame,) = frames
    assert (frame.type, frame.version, frame.payload) == (kind, version, payload)
    assert (frame.session, frame.sequence, frame.tag) == (7, 8, 9)
    assert decoder.faults == []


@given(st.binary(max_size=6000))
def test_any_bytes_decode_or_are_counted(data):
    decoder = RawDecoder()
    frames = decoder.feed(data + b"\x00", 0.0)
    assert len(frames) + len(decoder.faults) <= data.count(b"\x00") + 2


def test_a_wrong_crc_is_told():
    decoder = RawDecoder()
    assert decoder.feed(encode_raw(5, session=1, sequence=2, tag=3, crc_error=1), 0.0) == []
    assert "CRC-32" in decoder.faults[0]


def test_a_type_that_is_none_makes_no_frame_of_the_protocol():
    (raw,) = RawDecoder().feed(encode_raw(0x3F, session=1, sequence=2, tag=3), 0.0)
    with pytest.raises(FrameError):
        raw.frame()


@given(
    drift_ppm=st.floats(-5000.0, 5000.0),
    delays=st.lists(
        st.tuples(st.floats(1e-6, 0.05), st.floats(1e-6, 0.05)), min_size=2, max_size=30
    ),
)
def test_the_bounds_of_the_tick_rate_hold_whatever_the_delays_are(drift_ppm, delays):
    tick_hz = 1e6
    trips = [
        RoundTrip(
            sent_s=i - out_s,
            received_s=i + back_s,
            ticks=round(i * tick_hz * (1.0 + 1e-6 * drift_ppm)),
        )
        for i, (out_s, back_s) in enumerate(delays)
    ]
    found = tick_rate(trips, nominal_tick_hz=tick_hz)
    assert found.steady
    # One tick of rounding at either end of the shortest span, 0.9 s, is 1.2e-6.
    assert abs(found.drift - 1e-6 * drift_ppm) <= found.bound + 1.2e-6


def test_ticks_that_jump_are_not_steady():
    trips = [RoundTrip(sent_s=t, received_s=t + 1e-3, ticks=int(1e6 * t)) for t in range(5)]
    trips.append(RoundTrip(sent_s=6.0, received_s=6.001, ticks=3_000_000))
    assert not tick_rate(trips, nominal_tick_hz=1e6).steady


def test_trips_that_all_overlap_tell_nothing():
    trips = [
        RoundTrip(sent_s=0.0, received_s=1.0, ticks=1),
        RoundTrip(sent_s=0.5, received_s=1.5, ticks=2),
    ]
    assert tick_rate(trips, nominal_tick_hz=1e6).bound == np.inf


@given(
    values=st.lists(st.integers(-3, 3), min_size=2, max_size=200),
    level=st.integers(-2, 2),
    slope=st.sampled_from(Slope),
    length=st.integers(1, 20),
    data=st.data(),
)
def test_expected_blocks_are_those_of_a_board_that_looks_sample_by_sample(
    values, level, slope, length, data
):
    pretrigger = data.draw(st.integers(0, length - 1))
    buffers = data.draw(st.integers(0, 5))
    held, missed, busy_until = [], [], pretrigger
    for i in range(1, len(values)):
        before, after = values[i - 1], values[i]
        rising = slope is Slope.RISING
        crossed = before < level <= after if rising else before > level >= after
        if crossed and i >= busy_until:
            (held if len(held) < buffers else missed).append(i)
            busy_until = i - pretrigger + length
    found = expected_blocks(
        np.array(values, dtype=np.int32),
        level=level,
        slope=slope,
        pretrigger=pretrigger,
        length=length,
        buffers=buffers,
    )
    assert (list(found.held), list(found.missed)) == (held, missed)


@dataclass
class Bench:
    tried: list


def step(name, run):
    return Step(name=name, title=name, wanted="w", hint="h", run=run)


def test_a_device_that_is_lost_fails_one_step_and_leaves_the_others_unchecked():
    def lose(bench):
        bench.tried.append("lose")
        raise DeviceLostError("gone")

    def ready(bench):
        if bench.tried:
            raise DeviceLostError("still gone")

    told = []
    report = run_steps(
        "d",
        [step("a", lose), step("b", lambda _: passed("ok"))],
        Bench(tried=[]),
        make_ready=ready,
        tell=told.append,
    )
    assert [s.verdict for s in report.steps] == [Verdict.FAIL, Verdict.NOT_CHECKED]
    assert report.step("b").came == "still gone"
    assert told == ["a", report.steps[0], "b", report.steps[1]]


def test_steps_that_were_not_checked_do_not_fail_a_report():
    report = run_steps(
        "d",
        [step("a", lambda _: unchecked("why")), step("b", lambda _: passed("ok"))],
        None,
        make_ready=lambda _: None,
        tell=lambda _: None,
    )
    assert report.passed
    assert report.step("a").hint == "h"
    assert report.step("b").hint == ""
    with pytest.raises(KeyError):
        Report(device="d", steps=()).step("a")


def test_a_single_problem_is_not_taken_apart():
    assert failed("one problem").came == "one problem"


@pytest.mark.parametrize(
    ("delay_s", "verdict"), [(0.001, Verdict.PASS), (0.02, Verdict.NOT_CHECKED)]
)
def test_a_clock_that_round_trips_hardly_bound_is_not_checked(delay_s, verdict):
    trips = [
        RoundTrip(sent_s=t, received_s=t + delay_s, ticks=int(1e6 * (t + 0.5 * delay_s)))
        for t in np.linspace(0.0, 3.0, 7)
    ]
    bench = SimpleNamespace(
        dictionary=SimpleNamespace(tick_hz=1_000_000),
        recording=lambda: SimpleNamespace(frames=(), statuses=[(None, trip) for trip in trips]),
    )
    found = check_clock(bench)
    assert found.verdict is verdict
    assert ("check again" in found.came) is (verdict is Verdict.NOT_CHECKED)


class SlowProbe:
    """A board whose STATUS takes `delay_s` to come, on a clock that passes only by waiting."""

    frames = faults = ()
    configuration = SimpleNamespace(channel_mask=1)

    def __init__(self, delay_s):
        self.now_s = 0.0
        self.delay_s = delay_s
        self.clock = SimpleNamespace(now_s=lambda: self.now_s, wall_s=lambda lab_s: lab_s)

    def collect(self, lab_s):
        self.now_s += lab_s

    def status_trip(self):
        sent_s = self.now_s
        self.now_s += self.delay_s
        ticks = round(1e6 * (sent_s + 0.5 * self.delay_s))
        return None, RoundTrip(sent_s=sent_s, received_s=self.now_s, ticks=ticks)

    def begin(self, configuration):
        """Begin: nothing to do."""

    def end(self):
        """End: nothing to do."""


# A bound is the delay over the time between the first and the last trip.
@pytest.mark.parametrize(
    ("delay_s", "lasts_s"), [(0.001, (3.0, 3.6)), (0.02, (20.0, 21.0)), (0.2, (60.0, 60.8))]
)
def test_a_run_goes_on_until_its_round_trips_tell_the_clock(delay_s, lasts_s):
    probe = SlowProbe(delay_s)
    record(
        probe,
        probe.configuration,
        3.0,
        most_s=60.0,
        enough=lambda trips: tick_rate(trips, nominal_tick_hz=1e6).told,
    )
    assert lasts_s[0] <= probe.now_s <= lasts_s[1]
