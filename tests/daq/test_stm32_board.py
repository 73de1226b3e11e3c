"""The board with an STM32G474RE: its program, compiled for this machine, on a model of its chip.

The chip's registers, pins and clocks, the converter, the sensors' memories and supplies are models
of their data sheets; `faults` are what the chip would not have done.
"""

import itertools
import math
from datetime import date
from fractions import Fraction

import numpy as np
import pytest
from support.ads131m04_model import Ads131m04
from support.one_wire_model import OneWireMemory, paged
from support.stm32g474_board import OK_MV, Stm32Board, compiled
from support.teds_bits import iepe

from armodal.daq.board_link import BoardLink
from armodal.daq.check import BOARD_STEPS, BoardCheckOptions, Verdict, check_board
from armodal.protocols.board import (
    BlockInfo,
    Configuration,
    FrameType,
    Overflow,
    Slope,
    decode_payload,
    decode_samples,
)
from armodal.protocols.board.records import IepeState
from armodal.protocols.errors import BoardRefusedError
from armodal.protocols.teds import decode_teds

SHEET = iepe(0.0102, calibrated=date(2026, 3, 2), serial=4_711)
OPTIONS = BoardCheckOptions(duration_s=1.0, rate_hz=Fraction(4_000))
RAIL_MV = 24_000.0
NOISE = np.random.default_rng(1).integers(-300, 300, (65_536, 4)).tolist()
SLOW = 4_000  # Hz: a preview of four channels fits the UART


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    made = compiled(tmp_path_factory.mktemp("stm32"))
    if made is None:
        pytest.skip("no C compiler on this machine")
    return made


def configuration(rate_hz=SLOW, **changes):
    fields = {
        "rate_hz": Fraction(rate_hz),
        "channel_mask": 0b1111,
        "trigger_channel": 0,
        "trigger_level_counts": 50_000,
        "slope": Slope.RISING,
        "pretrigger": 64,
        "block_length": 256,
        "stream": True,
    }
    return Configuration(**(fields | changes))


def noise(i):
    return tuple(NOISE[i % len(NOISE)])


def linked(board):
    link = BoardLink(board.open(), board.clock)
    return link, link.hello()


def heard(board, link, seconds):
    """Frames that come within so much time."""
    frames, until_s = [], board.clock.now_s() + seconds
    while board.clock.now_s() < until_s:
        board.clock.sleep(0.005)
        frames += link.pump()
    return frames


def preview_of(frames):
    return [decode_samples(f) for f in frames if f.header.type is FrameType.STREAM]


def test_the_board_tells_what_its_sensors_memories_hold(library):
    memory = OneWireMemory(0x2D, paged(SHEET).ljust(128, b"\0"))
    board = Stm32Board(library, memories={1: memory})
    _, found = linked(board)
    channels = found.dictionary.channels
    assert found.dictionary.board_id == "nucleo-g474re"
    assert decode_teds(channels[1].teds) == decode_teds(SHEET)
    assert [len(c.teds) for c in channels] == [0, len(channels[1].teds), 0, 0]
    assert [c.iepe for c in channels] == [IepeState.OK] * 4
    assert all(board.model.supply_on(channel) for channel in range(4))
    assert board.model.faults == []


@pytest.mark.parametrize("crystal", [True, False])
def test_it_runs_as_fast_without_its_crystal(library, crystal):
    board = Stm32Board(library, crystal=crystal)
    linked(board)
    assert board.model.system_hz() == 150e6
    assert board.model.faults == []


@pytest.mark.parametrize(
    ("model", "rate_hz", "words"),
    [
        (
            {"oscillator_hz": 0},
            4_000,
            "no clock of 8.192 MHz at PA15: check the converter's supply",
        ),
        ({"chip": Ads131m04(dead=True)}, 4_000, "the converter does not answer on SPI1"),
        ({}, 5_000, "the converter makes 32000, 16000, 8000 and 4000 Hz"),
        pytest.param(
            {}, 2_000, "the converter makes 32000, 16000, 8000 and 4000 Hz", marks=pytest.mark.long
        ),
    ],
    ids=["no oscillator", "dead", "not a rate", "another filter"],
)
def test_what_cannot_be_measured_is_refused_in_words(library, model, rate_hz, words):
    board = Stm32Board(library, **model)
    link, _ = linked(board)
    with pytest.raises(BoardRefusedError, match=words):
        link.configure(configuration(rate_hz))


@pytest.mark.parametrize("rate_hz", [4_000, pytest.param(32_000, marks=pytest.mark.long)])
def test_a_hit_comes_as_it_was_converted(library, rate_hz):
    """At 32 kHz too, where frames of the converter follow one another in 31 us."""

    def hit(i):
        return (100_000 if i == 1_000 else 0, i, -i, i * 7 % 1000)

    board = Stm32Board(library, convert=hit)
    link, _ = linked(board)
    link.configure(configuration(rate_hz, stream=rate_hz == SLOW))
    link.start()
    frames = heard(board, link, 1_300 / rate_hz + 0.2)
    (ready,) = [f for f in frames if f.header.type is FrameType.BLOCK_READY]
    info = decode_payload(BlockInfo, ready.payload)
    data = [decode_samples(f) for f in frames if f.header.type is FrameType.BLOCK_DATA]
    counts = np.concatenate([samples.counts for samples in data])
    wanted = [hit(i) for i in range(1_000 - 64, 1_000 - 64 + 256)]
    np.testing.assert_array_equal(counts, wanted)
    assert info.trigger_ticks == board.model.ready_ticks[1_000]
    status, _ = link.status()
    assert (status.adc_overruns, status.stream_samples_dropped) == (0, 0)
    assert board.model.faults == []


@pytest.mark.long
def test_the_preview_has_every_sample_once(library):
    board = Stm32Board(library, convert=lambda i: (i, i, i, i))
    link, _ = linked(board)
    link.configure(configuration(trigger_level_counts=8_000_000))
    link.start()
    samples = preview_of(heard(board, link, 0.4))
    counts = np.concatenate([s.counts[:, 0] for s in samples])
    assert len(counts) > 1_400
    assert (np.diff(counts) == 1).all()
    assert [s.first_sample for s in samples] == list(range(0, 64 * len(samples), 64))


def test_samples_that_nobody_fetched_in_time_are_counted(library):
    board = Stm32Board(library, convert=lambda i: (i, i, i, i))
    link, _ = linked(board)
    link.configure(configuration(trigger_level_counts=8_000_000))
    link.start()
    heard(board, link, 0.2)
    board.model.masked_until_s = board.model.t_s + 0.01  # 40 samples, of which the chip keeps two
    frames = heard(board, link, 0.2)
    samples = preview_of(frames)
    status, _ = link.status()
    assert status.adc_overruns == 1
    assert frames[-1].header.overflow & Overflow.ADC
    # Each count is its sample's number: what is missing is missing in the index as well.
    offsets = {int(s.counts[0, 0]) - s.first_sample for s in samples}
    assert len(offsets) == 1
    assert all((np.diff(s.counts[:, 0]) == 1).all() for s in samples)
    steps = [
        b.first_sample - a.first_sample - len(a.counts) for a, b in itertools.pairwise(samples)
    ]
    assert 37 <= sum(steps) <= 40
    assert board.model.faults == []


def test_a_broken_cable_is_told_and_a_hard_hit_is_not(library):
    board = Stm32Board(library)
    began_s = board.model.t_s

    def bias_mv(channel, t_s):
        after_s = t_s - began_s
        hit = channel == 0 and 0.1 <= after_s < 0.103  # 3 ms at the rail
        return RAIL_MV if hit or (channel == 2 and after_s > 0.3) else OK_MV

    board.model.bias_mv = bias_mv
    link, found = linked(board)
    board.clock.sleep(0.25)
    assert link.hello().dictionary_hash == found.dictionary_hash
    board.clock.sleep(0.3)
    later = BoardLink(board.open(), board.clock).hello()
    assert later.dictionary_hash != found.dictionary_hash
    assert [c.iepe for c in later.dictionary.channels] == [
        IepeState.OK, IepeState.OK, IepeState.OPEN, IepeState.OK,
    ]  # fmt: skip


def test_a_short_is_told_at_boot(library):
    board = Stm32Board(library, bias_mv=lambda channel, t_s: 300.0 if channel == 3 else OK_MV)
    _, found = linked(board)
    assert found.dictionary.channels[3].iepe is IepeState.SHORT


@pytest.mark.long
def test_the_whole_check_finds_nothing(library):
    """Its UART has no flow control: what the line loses is not told from what the board drops."""
    board = Stm32Board(library, convert=noise)
    report = check_board(board.open, OPTIONS, clock=board.clock)
    others = {s.name: s.came for s in report.steps if s.verdict is not Verdict.PASS}
    assert list(others) == ["stream-overflow"]
    assert "no flow control" in others["stream-overflow"]
    assert {s.verdict for s in report.steps} == {Verdict.PASS, Verdict.NOT_CHECKED}
    assert len(report.steps) == len(BOARD_STEPS)
    assert board.model.faults == []
    assert math.isclose(board.model.system_hz(), 150e6)
