from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from support.synthetic_laboratory import ramp

from armodal.hil_sim.faults import Fault, FaultSet
from armodal.hil_sim.link_faults import ChannelFaults, LinkFaults
from armodal.hil_sim.streams import stream
from armodal.protocols.board.codec import (
    FrameDecoder,
    encode_frame,
)
from armodal.protocols.board.messages import (
    encode_payload,
)
from armodal.protocols.board.records import (
    Configuration,
    FrameType,
    Header,
    Slope,
)
from armodal.protocols.errors import PlantError


@pytest.mark.parametrize(
    "name", ["flood", "", "@5", "bit-flip@", "bit-flip@-1", "bit-flip@5+0", "bit-flip@1e3", "x@5"]
)
def test_a_fault_that_is_not_known_is_refused_with_the_list(name):
    with pytest.raises(PlantError, match=r"wanted a fault the laboratory knows .*bit-flip"):
        FaultSet([name])


def test_a_scripted_fault_begins_and_ends_at_its_samples():
    faults = FaultSet(["bit-flip@100+50"])
    active = []
    for sample in range(0, 300, 10):
        faults.reach(sample)
        if Fault.BIT_FLIP in faults:
            active.append(sample)
    assert active == [100, 110, 120, 130, 140]


def test_a_scripted_fault_lasts_over_another_start_and_comes_once():
    faults = FaultSet(["bit-flip@100+50"])
    faults.reach(120)
    faults.reach(10)  # the board was started anew
    assert Fault.BIT_FLIP in faults
    faults.reach(60)
    assert Fault.BIT_FLIP not in faults
    faults.reach(200)
    assert Fault.BIT_FLIP not in faults


def test_the_next_change_is_known_so_that_samples_are_divided_there():
    faults = FaultSet(["bit-flip@100+50"])
    assert faults.until_change(30) == 70
    faults.reach(100)
    assert faults.until_change(100) == 50
    faults.reach(150)
    assert faults.until_change(150) is None


def frames(n):
    return [
        encode_frame(Header(type=FrameType.STREAM, session=1, sequence=i), bytes(range(40)))
        for i in range(n)
    ]


def carried(name, n=200):
    link = LinkFaults(FaultSet([name]), partial(stream, 1))
    decoder = FrameDecoder()
    found = decoder.feed(b"".join(link.carry(frame) for frame in frames(n)))
    return [frame.header.sequence for frame in found], decoder


def test_dropped_frames_are_missing_and_no_other():
    came, decoder = carried("frame-drop")
    assert came == sorted(set(came))
    assert 100 < len(came) < 180
    assert decoder.bad_frames == 0


def test_duplicated_frames_come_twice_in_a_row():
    came, _ = carried("frame-duplicate")
    assert sorted(set(came)) == list(range(200))
    assert len(came) > 200


def test_reordered_frames_all_come_but_the_one_on_its_way():
    came, _ = carried("frame-reorder")
    assert came != sorted(came)
    assert len(came) >= 199


@pytest.mark.parametrize("name", ["bit-flip", "frame-truncate"])
def test_a_spoilt_frame_is_never_taken_for_a_valid_one(name):
    came, decoder = carried(name)
    assert decoder.bad_frames > 10
    assert came == sorted(set(came))


@pytest.mark.parametrize("name", ["channel-stuck", "channel-clipped", "channel-garbage"])
def test_a_faulty_channel_leaves_the_others_alone(name):
    counts = np.column_stack([np.arange(50), ramp(0, 50)]).astype(np.int32) * 1000
    spoilt = ChannelFaults(FaultSet([name]), partial(stream, 2)).spoil(counts)
    differing = np.flatnonzero((spoilt != counts).any(axis=0))
    assert len(differing) == 1
    if name == "channel-stuck":
        assert len(np.unique(spoilt[:, differing[0]])) == 1


def begun(bench):
    bench.host.ask(FrameType.HELLO)
    configuration = Configuration(
        rate_hz=Fraction(1600), channel_mask=15, trigger_channel=0, trigger_level_counts=100_000,
        slope=Slope.RISING, pretrigger=10, block_length=100, stream=True,
    )  # fmt: skip
    bench.host.ask(FrameType.CONFIGURE, encode_payload(configuration))
    bench.host.ask(FrameType.START)


def passes(bench, seconds):
    for _ in range(round(seconds / 0.01)):
        bench.time.now_s += 0.01
        bench.board.step()
        bench.host.pump()


def test_a_rebooted_board_is_idle_under_another_session(bench):
    bench.faults.switch("board-reboot@500", active=True)
    begun(bench)
    session = bench.host.session
    passes(bench, 0.6)
    assert not bench.firmware.running
    assert bench.host.ask(FrameType.HELLO).header.session != session


def test_a_jump_of_the_clock_moves_ticks_and_no_sample(bench):
    begun(bench)
    passes(bench, 0.2)
    before = bench.host.ask(FrameType.STATUS)
    bench.firmware.jump_clock(3.0)
    after = bench.host.ask(FrameType.STATUS)
    assert after.header.ticks - before.header.ticks == pytest.approx(3_000_000, abs=1000)
    passes(bench, 0.2)
    streamed = [f.header.first_sample for f in bench.host.of(FrameType.STREAM)]
    assert np.all(np.diff(streamed) == np.diff(streamed)[0])


def test_a_drifting_clock_is_continuous(bench):
    bench.host.ask(FrameType.HELLO)
    first = bench.host.ask(FrameType.STATUS).header.ticks
    bench.firmware.drift_clock(500.0)
    bench.time.now_s += 10.0
    second = bench.host.ask(FrameType.STATUS).header.ticks
    # 50 ppm of the bench's clock and 500 ppm of drift, to a tick of rounding each.
    assert second - first == pytest.approx(10_000_000 * (1.0 + 550e-6), abs=2)


def test_an_unplugged_line_hangs_up(bench):
    begun(bench)
    name = bench.board_port.name
    # More than a pseudo-terminal takes while nobody reads.
    bench.board_port.queue(bytes(200_000))
    assert not bench.board_port.flush()
    bench.faults.switch("unplug", active=True)
    bench.time.now_s += 0.01
    bench.board.step()
    with pytest.raises(OSError, match="Input/output error"):
        bench.host.write(b"\0")
    assert bench.board_port.name != name
    assert bench.board_port.pending == 0
