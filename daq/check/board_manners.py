"""How the board takes what it should not be told, a second host, and a closed port."""

from __future__ import annotations

import numpy as np

from armodal.daq.check.board_bench import BoardBench, hello
from armodal.daq.check.board_blocks import compare_resent, hold_a_block
from armodal.daq.check.captured import SentBlock, noise_level
from armodal.daq.check.raw_frame import encode_raw
from armodal.daq.check.stream import stream_of
from armodal.daq.check.verdict import Finding, failed, passed
from armodal.protocols.board.codec import (
    PROTOCOL_VERSION,
)
from armodal.protocols.board.messages import (
    decode_reply,
    encode_payload,
)
from armodal.protocols.board.records import (
    BoardState,
    FrameType,
    Release,
    ReplyCode,
    Resend,
)
from armodal.protocols.errors import DeviceTimeoutError

__all__ = [
    "check_commands",
    "check_garbage",
    "check_hello_again",
    "check_reconnect",
    "check_session",
    "check_version",
]

LONGEST_STRETCH = 2093  # section 2
UNKNOWN_TYPE = 0x3F
OTHER_VERSION = PROTOCOL_VERSION + 1
COUNT_LAG_S = 0.1  # between two readings of next_sample and the host's clock
COUNT_LAG_WALL_S = 0.05


def _garbage(bench: BoardBench) -> list[tuple[str, bytes]]:
    """What is no frame, by section 2, each with its name."""
    rng = np.random.default_rng(bench.options.seed)
    session = bench.probe.session
    stop = encode_raw(FrameType.STOP, session=session, sequence=0, tag=0xFFFF)
    torn = encode_raw(FrameType.STOP, session=session, sequence=0, tag=0xFFFF, crc_error=1)
    return [
        ("300 random bytes", rng.bytes(300)),
        ("a stretch longer than any frame", b"\x01" * (2 * LONGEST_STRETCH)),
        ("a STOP with a wrong CRC", torn),
        ("a STOP cut in half", stop[: len(stop) // 2]),
        ("a frame of 7 bytes", b"\x00\x08abcdefg\x00"),
        ("a hundred delimiters", bytes(100)),
    ]


def check_garbage(bench: BoardBench) -> Finding:
    """Step `garbage`: whatever comes, the next command is answered and no sample is lost."""
    probe = bench.probe
    configuration = bench.configuration(bench.rate_hz)
    probe.begin(configuration)
    problems = []
    before = probe.status()
    for name, data in _garbage(bench):
        probe.port.write(data + b"\x00")
        try:
            state = probe.status().state
        except DeviceTimeoutError:
            return failed(f"the board has not answered STATUS since {name}")
        if state is not BoardState.RUNNING:
            problems.append(f"after {name} the board is {state.name}")
            break
    probe.collect(0.1)
    after = probe.status()
    if after.next_sample <= before.next_sample:
        problems.append("the sample count stands still")
    unasked = [f.type for f in probe.frames if f.type < FrameType.STREAM]
    others = [
        kind for kind in unasked if kind not in (FrameType.STATUS_REPLY, FrameType.START_REPLY)
    ]
    if others:
        problems.append(f"garbage was answered with a frame of type 0x{others[0]:02x}")
    if any(f.session != probe.session for f in probe.frames):
        problems.append("the session id has changed: the board has started anew")
    stream = stream_of(probe.frames, configuration.channel_mask.bit_count())
    holes = int(np.count_nonzero(~stream.present)) - after.stream_samples_dropped
    if holes > 0:
        problems.append(f"{holes} samples are missing from the preview")
    probe.end()
    return failed(problems) if problems else passed("every kind was passed over, no sample lost")


def check_hello_again(bench: BoardBench) -> Finding:
    """Step `hello-again`: a second HELLO tells the same and disturbs nothing."""
    probe = bench.probe
    level = noise_level(bench)
    if level is None:
        probe.begin(bench.configuration(bench.rate_hz))
    else:
        hold_a_block(bench, level)
    before = probe.status()
    problems = []
    for _ in range(2):
        again = hello(probe)
        if again is None:
            return failed("no answer to HELLO while RUNNING")
        if again.session != bench.first.session:
            problems.append(f"session {bench.first.session:08x} became {again.session:08x}")
        if again.data != bench.first.data or again.header_hash != bench.first.header_hash:
            problems.append("the dictionary is another one")
        if problems:
            return failed(problems)
    after = probe.status()
    if after.state is not before.state:
        problems.append(f"the state went from {before.state.name} to {after.state.name}")
    if after.next_sample < before.next_sample:
        problems.append("the sample count began anew")
    if after.buffered_blocks < before.buffered_blocks or after.oldest_block != before.oldest_block:
        problems.append("held blocks are gone")
    probe.end()
    return failed(problems) if problems else passed("same session, same dictionary, run goes on")


def check_commands(bench: BoardBench) -> Finding:
    """Step `commands`: every command is answered as sections 4 and 8 say, in every state."""
    probe = bench.probe
    configuration = encode_payload(bench.configuration(bench.rate_hz))
    problems = _answers(
        bench,
        "CONFIGURED",
        [
            (FrameType.CONFIGURE, configuration, ReplyCode.OK),
            (FrameType.STOP, b"", ReplyCode.OK),
            (UNKNOWN_TYPE, b"", ReplyCode.UNKNOWN_COMMAND),
            (FrameType.RESEND, b"\x01", ReplyCode.BAD_VALUE),
            (
                FrameType.RELEASE,
                encode_payload(Release(block_id=0xFFFF_FFF0)),
                ReplyCode.UNKNOWN_BLOCK,
            ),
            (
                FrameType.RESEND,
                encode_payload(Resend(block_id=0xFFFF_FFF0, first=0, count=1)),
                ReplyCode.UNKNOWN_BLOCK,
            ),
        ],
    )
    probe.begin(bench.configuration(bench.rate_hz))
    problems += _answers(
        bench,
        "RUNNING",
        [
            (FrameType.START, b"", ReplyCode.WRONG_STATE),
            (FrameType.CONFIGURE, configuration, ReplyCode.WRONG_STATE),
            (UNKNOWN_TYPE, b"\x01\x02", ReplyCode.UNKNOWN_COMMAND),
        ],
    )
    tag = probe.send(FrameType.BLOCK_READY, bytes(32))
    state = probe.status().state
    if any(f.tag == tag for f in probe.frames):
        problems.append("a frame of type 91 from the host is answered")
    if state is not BoardState.RUNNING:
        problems.append(f"after refused commands the state is {state.name}, not RUNNING")
    probe.end()
    return failed(problems) if problems else passed("answers as documented in both states")


def _answers(
    bench: BoardBench, state: str, commands: list[tuple[int, bytes, ReplyCode]]
) -> list[str]:
    problems = []
    for kind, payload, wanted in commands:
        name = FrameType(kind).name if kind in set(FrameType) else f"type {kind:02x}"
        what = f"{name} of {len(payload)} bytes in {state}"
        reply = bench.probe.reply(kind, payload, tries=2)
        if reply is None:
            problems.append(f"{what}: {wanted.name} wanted, no answer came")
            continue
        code, reason = decode_reply(reply.payload)
        if code is not wanted:
            problems.append(f"{what}: {wanted.name} wanted, got {code.name} {reason}".rstrip())
    return problems


def check_version(bench: BoardBench) -> Finding:
    """Step `version`: HELLO of another version is answered in one's own, the rest dropped."""
    probe = bench.probe
    problems = []
    reply = probe.reply(FrameType.HELLO, tries=2, version=OTHER_VERSION)
    if reply is None:
        problems.append(f"HELLO of version {OTHER_VERSION}: HELLO_REPLY wanted, no answer came")
    elif reply.version != PROTOCOL_VERSION:
        problems.append(f"HELLO_REPLY of version {reply.version}, {PROTOCOL_VERSION} wanted")
    tag = probe.send(FrameType.STATUS, version=OTHER_VERSION)
    probe.settle()
    if any(f.tag == tag and f.type == FrameType.STATUS_REPLY for f in probe.frames):
        problems.append(f"STATUS of version {OTHER_VERSION} was answered; it is to be dropped")
    if problems:
        return failed(problems)
    return passed(f"HELLO of version {OTHER_VERSION} answered in {PROTOCOL_VERSION}, rest dropped")


def check_session(bench: BoardBench) -> Finding:
    """Step `session`: a command for another session is refused and not carried out."""
    probe = bench.probe
    probe.begin(bench.configuration(bench.rate_hz))
    problems = []
    for other in (probe.session ^ 0x0000_0101, 0):
        for kind in (FrameType.STATUS, FrameType.STOP):
            code, _ = decode_reply(probe.ask(kind, session=other).payload)
            if code is not ReplyCode.WRONG_SESSION:
                problems.append(
                    f"{kind.name} for session {other:08x}: WRONG_SESSION wanted, got {code.name}"
                )
    state = probe.status().state
    if state is not BoardState.RUNNING:
        problems.append(f"a STOP for another session was carried out: the board is {state.name}")
    probe.clear()
    if state is BoardState.RUNNING:
        probe.end()
    return failed(problems) if problems else passed("refused, and the run went on")


def check_reconnect(bench: BoardBench) -> Finding:
    """Step `reconnect`: a closed and opened port finds the run going on and the blocks held."""
    level = noise_level(bench)
    block: SentBlock | None = None
    if level is None:
        bench.probe.begin(bench.configuration(bench.rate_hz))
    else:
        block = hold_a_block(bench, level)
    before = bench.probe.status()
    before_s = bench.clock.now_s()
    bench.reopen()
    again = hello(bench.probe)
    if again is None:
        return failed("no answer to HELLO after the port was closed and opened")
    problems = []
    if again.session != bench.first.session:
        return failed(
            f"session {bench.first.session:08x} became {again.session:08x}: the board has "
            "started anew"
        )
    if again.data != bench.first.data:
        problems.append("the dictionary is another one")
    after = bench.probe.status()
    if after.state is not BoardState.RUNNING:
        problems.append(f"the run has ended: {after.state.name}")
    counted_s = (after.next_sample - before.next_sample) / float(bench.rate_hz)
    passed_s = bench.clock.now_s() - before_s
    lag_s = COUNT_LAG_S + COUNT_LAG_WALL_S / bench.clock.wall_s(1.0)
    if abs(counted_s - passed_s) > lag_s + 0.01 * passed_s:
        problems.append(f"{counted_s:.3f} s of samples were counted in {passed_s:.3f} s")
    bench.probe.end()
    if block is not None and not problems:
        text = compare_resent(bench, block, 0, block.info.length)
        problems += [f"the block held: {text}"] if text else []
    if problems:
        return failed(problems)
    what = "" if block is None else f", block {block.info.block_id} came again as first sent"
    return passed(f"session {again.session:08x} went on{what}")
