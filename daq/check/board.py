"""Check of a board against `docs/board-protocol.md`, step by step, over its own line."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from armodal.daq.check.board_bench import BoardBench, BoardCheckOptions
from armodal.daq.check.board_blocks import check_pretrigger, check_resend, check_trigger
from armodal.daq.check.board_description import check_dictionary, check_each_rate, check_rates
from armodal.daq.check.board_manners import (
    check_commands,
    check_garbage,
    check_hello_again,
    check_reconnect,
    check_session,
    check_version,
)
from armodal.daq.check.board_overflow import check_block_overflow, check_stream_overflow
from armodal.daq.check.board_run import check_clock, check_framing, check_rate, check_samples
from armodal.daq.check.probe import BoardStepError
from armodal.daq.check.run import choose, run_steps
from armodal.daq.check.verdict import Report, Step, StepResult
from armodal.daq.clock import Clock, SystemClock
from armodal.daq.serial_port import BytePort
from armodal.protocols.board.messages import decode_reply
from armodal.protocols.board.records import FrameType, ReplyCode
from armodal.protocols.errors import DeviceTimeoutError

__all__ = ["BOARD_STEPS", "check_board"]

BOARD_STEPS: tuple[Step[BoardBench], ...] = (
    Step(
        name="dictionary",
        title="Dictionary",
        wanted="reads, its hash is the header's, figures are plausible, names unique",
        hint="sections 3 and 5: the hash is the low half of the CRC-32 of the whole array",
        run=check_dictionary,
    ),
    Step(
        name="rates",
        title="Rates and refusals",
        wanted="CONFIGURE is taken or refused as section 6 computes, each refusal with a reason",
        hint="section 6: compare capacity and link with the dictionary before anything is changed",
        run=check_rates,
    ),
    Step(
        name="each-rate",
        title="Every rate by ticks",
        wanted="each accepted rate is the one made, by the ticks of the preview, within 0.1 %",
        hint="section 6: refuse a rate that the converter cannot make exactly; section 3: ticks",
        run=check_each_rate,
    ),
    Step(
        name="framing",
        title="Frames of a long run",
        wanted="every frame whole, numbered + 1, with session and hash of the dictionary",
        hint="section 2 and 3; if frames are missing or torn, cable, baud rate or the host's load",
        run=check_framing,
    ),
    Step(
        name="samples",
        title="Sample count",
        wanted="every sample once, index without a jump, STATUS counts the same",
        hint="sections 3 and 10: the index counts converter samples, lost ones included",
        run=check_samples,
    ),
    Step(
        name="rate",
        title="Sample rate",
        wanted="the stated rate against the host's clock, within 200 ppm and what is known",
        hint="section 6: the rate is exact; look at the converter's clock and divider",
        run=check_rate,
    ),
    Step(
        name="clock",
        title="Clock",
        wanted="ticks never run backwards and keep tick_hz within 200 ppm and what is known",
        hint="section 3: one free-running counter, extended to 64 bits, read before sending",
        run=check_clock,
    ),
    Step(
        name="trigger",
        title="Trigger",
        wanted="the level is crossed at the trigger sample, in the slope's direction, in its time",
        hint="section 8: x[i-1] < T <= x[i]; the same counts that are sent must be compared",
        run=check_trigger,
    ),
    Step(
        name="pretrigger",
        title="Pre-trigger",
        wanted="as many samples before the trigger as configured, the same as in the preview",
        hint="section 8: the block begins at i - pretrigger; check the ring's read position",
        run=check_pretrigger,
    ),
    Step(
        name="resend",
        title="Resend and release",
        wanted="any range of a held block again, the same to the bit; none once released",
        hint="section 8: hold the block untouched until RELEASE",
        run=check_resend,
    ),
    Step(
        name="block-overflow",
        title="Block overflow",
        wanted="without RELEASE the buffer fills; each trigger missed is counted and flagged",
        hint="sections 3, 7 and 8: BLOCK and triggers_missed, both cleared by START only",
        run=check_block_overflow,
    ),
    Step(
        name="stream-overflow",
        title="Preview overflow",
        wanted="while nobody reads the preview drops; each sample missing is counted and flagged",
        hint="section 10: drop before a sequence number is taken; STREAM, stream_samples_dropped",
        run=check_stream_overflow,
    ),
    Step(
        name="garbage",
        title="Garbage",
        wanted="bytes that are no frame are passed over; the run and its count go on",
        hint="section 2: drop the stretch, begin anew at the next 00",
        run=check_garbage,
    ),
    Step(
        name="hello-again",
        title="Second HELLO",
        wanted="same session and dictionary; state, count and blocks untouched",
        hint="section 4.1: HELLO changes nothing",
        run=check_hello_again,
    ),
    Step(
        name="commands",
        title="Commands and states",
        wanted="each command is answered as section 4 says, unknown ones with UNKNOWN_COMMAND",
        hint="sections 4 and 4.1",
        run=check_commands,
    ),
    Step(
        name="version",
        title="Other version",
        wanted="HELLO of another version is answered in one's own, other frames are dropped",
        hint="section 3, Version",
        run=check_version,
    ),
    Step(
        name="session",
        title="Other session",
        wanted="a command for another session is refused with WRONG_SESSION and not carried out",
        hint="section 3, Session: compare before carrying out",
        run=check_session,
    ),
    Step(
        name="reconnect",
        title="Port closed and opened",
        wanted="the same session, run and blocks",
        hint="section 4.1: the board needs no sign of life; does DTR or the USB driver reset it?",
        run=check_reconnect,
    ),
)


def check_board(
    open_port: Callable[[], BytePort],
    options: BoardCheckOptions,
    *,
    clock: Clock | None = None,
    only: Iterable[str] = (),
    tell: Callable[[StepResult | str], None] = lambda _: None,
) -> Report:
    """Try every step on the board behind a port.

    Parameters
    ----------
    open_port
        Opens the port; asked again by the step `reconnect`.
    only
        Names of the steps to try; none for all.
    tell
        Is told the title of each step as it begins, and its result.

    Raises
    ------
    PortError, DeviceTimeoutError, FrameError
        If there is no port, or no board behind it.
    CheckError
        If a step is not known.
    """
    steps = choose(BOARD_STEPS, only)
    bench = BoardBench(open_port, clock or SystemClock(), options)
    try:
        return run_steps(bench.probe.port.name, steps, bench, make_ready=_make_ready, tell=tell)
    finally:
        _leave(bench)


def _make_ready(bench: BoardBench) -> None:
    """Stop what runs; a board that has restarted is taken up again by its new session.

    Raises
    ------
    DeviceTimeoutError
        If the board does not answer any more.
    """
    probe = bench.probe
    probe.clear()
    reply = probe.reply(FrameType.STOP)
    if reply is None or decode_reply(reply.payload)[0] is ReplyCode.WRONG_SESSION:
        found = bench.meet_again()
        if found is None:
            raise DeviceTimeoutError("the board no longer answers")
        probe.want_ok(FrameType.STOP)
    probe.settle()
    probe.clear()


def _leave(bench: BoardBench) -> None:
    """Leave the board stopped, if it still listens."""
    try:
        bench.probe.reply(FrameType.STOP, tries=1)
    except (OSError, BoardStepError):
        return
    finally:
        bench.close()
