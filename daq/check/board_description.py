"""Steps: the board describes itself soundly, and refuses what it cannot do."""

from __future__ import annotations

import struct
from datetime import date
from fractions import Fraction

from armodal.daq.check.board_bench import RATES_HZ, BoardBench
from armodal.daq.check.probe import TRIES
from armodal.daq.check.stream import record
from armodal.daq.check.verdict import Finding, failed, passed, unchecked
from armodal.protocols.board.limits import (
    refusal,
)
from armodal.protocols.board.messages import (
    decode_reply,
    dictionary_hash,
    encode_payload,
)
from armodal.protocols.board.records import (
    BoardDictionary,
    BoardState,
    Channel,
    Configuration,
    FrameType,
    ReplyCode,
)
from armodal.protocols.board.samples import (
    BYTES_PER_COUNT,
    COUNT_MAX,
)
from armodal.protocols.errors import FrameError

__all__ = ["check_dictionary", "check_each_rate", "check_rates"]

# The scale times the largest count should be about the full scale: a board whose two figures
# disagree by more has one of them in another unit.
FULL_SCALE_RATIO = (0.5, 2.0)
LONGEST_GROUP_DELAY = 4096  # samples; a longer filter is a figure in another unit
SHORTEST_TEDS = 8  # basic TEDS of IEEE 1451.4 is 64 bits
RATE_TOLERANCE = 1e-3  # of a rate by the board's own ticks, which come from one crystal
EACH_RATE_S = 0.5
EACH_RATE_WALL_S = 0.1


def check_dictionary(bench: BoardBench) -> Finding:
    """Step `dictionary`."""
    found = bench.first
    computed = dictionary_hash(found.data)
    problems = []
    if computed != found.header_hash:
        problems.append(
            f"the dictionary's hash is {computed:04x}, the header of HELLO_REPLY says "
            f"{found.header_hash:04x}"
        )
    if found.session == 0:
        problems.append("session id 0")
    try:
        dictionary = bench.dictionary
    except FrameError as error:
        return failed([*problems, f"the dictionary cannot be read: {error}"])
    problems += _implausible(dictionary)
    if problems:
        return failed(problems)
    names = ", ".join(f"{c.name} ({c.unit})" for c in dictionary.channels)
    return passed(
        f"{dictionary.board_id}, firmware {dictionary.firmware}: {names}; hash {computed:04x}"
    )


def _implausible(dictionary: BoardDictionary) -> list[str]:
    problems = []
    if not dictionary.board_id:
        problems.append("board_id is empty")
    if dictionary.filter_group_delay_samples > LONGEST_GROUP_DELAY:
        problems.append(f"filter group delay of {dictionary.filter_group_delay_samples:g} samples")
    smallest = BYTES_PER_COUNT * len(dictionary.channels)
    if dictionary.block_capacity < smallest:
        problems.append(f"block capacity of {dictionary.block_capacity} B holds no sample")
    for channel in dictionary.channels:
        problems += [f"{channel.name}: {text}" for text in _implausible_channel(channel)]
    return problems


def _implausible_channel(channel: Channel) -> list[str]:
    problems = []
    ratio = abs(channel.scale) * COUNT_MAX / channel.full_scale
    if not FULL_SCALE_RATIO[0] <= ratio <= FULL_SCALE_RATIO[1]:
        problems.append(
            f"scale x largest count is {abs(channel.scale) * COUNT_MAX:.3g} {channel.unit}, full "
            f"scale {channel.full_scale:.3g} {channel.unit}"
        )
    units = {"force": "N", "acceleration": "m/s^2"}
    wanted = units.get(channel.quantity)
    if wanted is not None and channel.unit != wanted:
        problems.append(f"{channel.quantity} in {channel.unit!r}, SI unit {wanted!r} wanted")
    if channel.calibration_date:
        try:
            date.fromisoformat(channel.calibration_date)
        except ValueError:
            problems.append(f"calibration date {channel.calibration_date!r} is none")
    if 0 < len(channel.teds) < SHORTEST_TEDS:
        problems.append(f"TEDS of {len(channel.teds)} bytes; a basic TEDS has {SHORTEST_TEDS}")
    return problems


def check_rates(bench: BoardBench) -> Finding:
    """Step `rates`: every refusal is as section 6 computes it, and has a reason."""
    dictionary = bench.dictionary
    base = bench.configuration(bench.rate_hz)
    problems, codes = [], set()
    tried = [bench.configuration(rate) for rate in RATES_HZ]
    tried += [bench.configuration(rate, stream=False) for rate in RATES_HZ]
    longest = dictionary.block_capacity // (BYTES_PER_COUNT * len(dictionary.channels))
    too_long = min(longest + 1, 0xFFFF_FFFF)
    tried += [
        bench.configuration(base.rate_hz, stream=False, block_length=length)
        for length in {max(longest, 1), too_long}
    ]
    tried += _impossible(base, len(dictionary.channels))
    for configuration in tried:
        code, reason = bench.configure(configuration)
        codes.add(code)
        problem = _unlike_expected(configuration, dictionary, code, reason)
        if problem:
            problems.append(problem)
    problems += _malformed_taken(bench, encode_payload(base))
    state = bench.probe.status().state
    if state is not BoardState.CONFIGURED:
        problems.append(f"after a refused CONFIGURE the state is {state.name}, not CONFIGURED")
    if problems:
        return failed(problems)
    rates = ", ".join(f"{float(rate):.6g}" for rate in bench.accepted)
    note = "" if ReplyCode.LINK in codes else "; LINK could not be provoked on this link"
    return passed(f"takes {rates} Hz with the preview; refusals as computed{note}")


def _impossible(base: Configuration, n_channels: int) -> list[Configuration]:
    def but(**changes: object) -> Configuration:
        fields = {name: getattr(base, name) for name in base.__slots__}
        return Configuration(**(fields | changes))

    beyond = base.channel_mask + 1 if n_channels < 32 else 0
    return [
        but(channel_mask=0),
        but(channel_mask=beyond),
        but(trigger_channel=n_channels),
        but(pretrigger=base.block_length),
        but(trigger_level_counts=COUNT_MAX + 1),
    ]


def _malformed_taken(bench: BoardBench, payload: bytes) -> list[str]:
    problems = []
    for malformed, what in _malformed(payload):
        # CONFIGURE is the longest command; section 2 lets a board pass over what is longer.
        may_pass_over = len(malformed) > len(payload)
        tries = 1 if may_pass_over else TRIES
        reply = bench.probe.reply(FrameType.CONFIGURE, malformed, tries=tries)
        if reply is None:
            if not may_pass_over:
                problems.append(f"CONFIGURE with {what}: BAD_VALUE wanted, no answer came")
            continue
        code, _ = decode_reply(reply.payload)
        if code is not ReplyCode.BAD_VALUE:
            problems.append(f"CONFIGURE with {what}: BAD_VALUE wanted, got {code.name}")
    return problems


def _malformed(payload: bytes) -> list[tuple[bytes, str]]:
    zero = struct.pack("<I", 0)
    return [
        (payload[:-1], "a byte too few"),
        (payload + b"\0", "a byte too many"),
        (zero + payload[4:], "a rate of 0"),
        (payload[:4] + zero + payload[8:], "a rate denominator of 0"),
        (payload[:13] + b"\2" + payload[14:], "slope 2"),
    ]


def _unlike_expected(
    configuration: Configuration, dictionary: BoardDictionary, code: ReplyCode, reason: str
) -> str | None:
    expected = refusal(configuration, dictionary)
    what = (
        f"rate {float(configuration.rate_hz):.6g} Hz, mask 0x{configuration.channel_mask:x}, "
        f"block {configuration.block_length}, preview {'on' if configuration.stream else 'off'}"
    )
    if code is not ReplyCode.OK and not reason:
        return f"{what}: refused with {code.name} without a reason"
    if expected is None:
        # A rate that the converter cannot make is refused with BAD_VALUE, and only the board knows.
        if code in (ReplyCode.OK, ReplyCode.BAD_VALUE):
            return None
        return (
            f"{what}: refused with {code.name} ({reason}), which the dictionary does not call for"
        )
    if code is expected[0]:
        return None
    if code is ReplyCode.BAD_VALUE and expected[0] in (ReplyCode.LINK, ReplyCode.CAPACITY):
        return None
    took = "accepted" if code is ReplyCode.OK else f"refused with {code.name}"
    return f"{what}: to be refused with {expected[0].name} ({expected[1]}), was {took}"


def check_each_rate(bench: BoardBench) -> Finding:
    """Step `each-rate`: a short run at every accepted rate, timed by the board's own ticks."""
    problems, measured = [], []
    tick_hz = bench.dictionary.tick_hz
    for rate_hz in bench.find_rates():
        lab_s = max(EACH_RATE_S, 200.0 / float(rate_hz), EACH_RATE_WALL_S / bench.clock.wall_s(1.0))
        found = _measured_hz(bench, rate_hz, lab_s, tick_hz)
        if found is None:
            problems.append(f"{float(rate_hz):.6g} Hz: fewer than two STREAM frames came")
            continue
        measured_hz, uncertainty = found
        off = measured_hz / float(rate_hz) - 1.0
        measured.append(abs(off))
        if abs(off) > RATE_TOLERANCE + uncertainty:
            problems.append(
                f"{float(rate_hz):.6g} Hz asked for, {measured_hz:.6g} Hz by its own ticks "
                f"({100 * off:+.2f} %)"
            )
    if problems:
        return failed(problems)
    if not measured:
        return unchecked("no rate was accepted with the preview on")
    return passed(f"{len(measured)} rates, largest deviation {1e6 * max(measured):.0f} ppm")


def _measured_hz(
    bench: BoardBench, rate_hz: Fraction, lab_s: float, tick_hz: int
) -> tuple[float, float] | None:
    """Sample rate in Hz by the ticks of first and last STREAM frame, and its relative bound."""
    stream = record(bench.probe, bench.configuration(rate_hz), lab_s).stream
    if len(stream.first) < 2:
        return None
    samples = int(stream.first[-1] - stream.first[0])
    ticks = int(stream.ticks[-1]) - int(stream.ticks[0])
    if samples <= 0 or ticks <= 0:
        return None
    # Either tick may be latched up to one tick and 10 us late (section 3).
    return samples * tick_hz / ticks, 2.0 * (1.0 + 1e-5 * tick_hz) / ticks
