"""The body of the acquisition process: open, loop, hand over, close.

A process of its own, because a reader beside a redrawing screen loses samples. It owns both
devices and the journal; it hears commands and tells events over one connection.
"""

from __future__ import annotations

import gc
import math
import secrets
import signal
import threading
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from armodal.daq import session_machine
from armodal.daq.board_link import BoardLink
from armodal.daq.board_session import BoardSession
from armodal.daq.clock import Clock
from armodal.daq.commands import Command, Stop
from armodal.daq.events import BoardFound, Failed, Finished, SessionOpened
from armodal.daq.front_end.opening import is_front_end
from armodal.daq.joint_source import JointSource
from armodal.daq.journal_mirror import MirroredJournal, begin, go_on
from armodal.daq.journal_writer import JournalWriter
from armodal.daq.judge import prepare_judge
from armodal.daq.losses import LossTally
from armodal.daq.open_joints import hear_every_joint, open_joints
from armodal.daq.session_loop import SessionLoop
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.surroundings import EventQueue, Surroundings
from armodal.protocols.board.records import IepeState
from armodal.protocols.errors import (
    ArmodalError,
    BoardRefusedError,
    DeviceLostError,
    DeviceTimeoutError,
    FrameError,
    JournalError,
)
from armodal.protocols.file_layer import DISK, FileLayer
from armodal.protocols.front_end import load_front_end
from armodal.protocols.sensor_memory import load_sensors, remember_sensors, unlike_before
from armodal.protocols.session.journal import End, Journal, Mark, MarkKind, encode_end, encode_mark
from armodal.protocols.session.journal_payloads import CALIBRATION
from armodal.protocols.session.moved_points import arm_with_moves
from armodal.protocols.session.progress import roving_point
from armodal.protocols.session.records import SessionHeader
from armodal.protocols.teds import contradictions

__all__ = ["run_acquisition"]

TURN_WALL_S = 0.012  # the fastest stream takes 19 ms to fill the smallest pseudo-terminal
FAST_TURN_WALL_S = 0.002  # where the laboratory's clock runs faster than the host's
IDLE_WALL_S = 0.02
FAREWELL_WALL_S = 2.0
FAILED_EXIT_CODE = 2
GONE = "the operator's program has gone"


@dataclass(slots=True)
class _Journal:
    files: FileLayer
    writer: JournalWriter | MirroredJournal | None = None
    earlier: Journal | None = None


def run_acquisition(
    settings: AcquisitionSettings,
    channel: Connection[Any, Any],
    surroundings: Surroundings | None = None,
    files: FileLayer = DISK,
) -> int:
    """Run a session until its plan is done, `Stop` comes, the listener goes, or it fails.

    Parameters
    ----------
    settings
        Ports, arm, plan, journal.
    channel
        Receives commands (`daq.commands`), is sent events (`daq.events`). A slow listener is
        never waited for.
    surroundings
        Clock and lines; those of this machine when None.
    files
        What the journal is written through.

    Returns
    -------
    int
        Exit code: 0, or 2 after a `Failed` event.
    """
    _leave_interrupts_to_the_operator()
    prepare_judge()
    surroundings = surroundings or Surroundings.of(settings)
    outbox = surroundings.make_outbox(channel)
    journal = _Journal(files=files)
    try:
        with ExitStack() as stack:
            finished = _run(settings, channel, surroundings, outbox, journal, stack)
    except ArmodalError as error:
        path = str(journal.writer.path) if journal.writer else None
        outbox.put(Failed(message=str(error), kind=type(error).__name__, journal=path))
        outbox.finish(FAREWELL_WALL_S)
        return FAILED_EXIT_CODE
    outbox.put(finished)
    outbox.finish(FAREWELL_WALL_S)
    return 0


def _leave_interrupts_to_the_operator() -> None:
    """Ignore Ctrl-C, which a terminal sends to both: the operator's program says stop."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _run(
    settings: AcquisitionSettings,
    channel: Connection[Any, Any],
    surroundings: Surroundings,
    outbox: EventQueue,
    journal: _Journal,
    stack: ExitStack,
) -> Finished:
    clock = surroundings.clock
    _check_journal_name(settings.journal)
    if settings.resume:
        _resume(settings, journal, stack)
    joints = open_joints(settings, surroundings)
    stack.callback(joints.close)
    port = surroundings.open_board(settings)
    stack.callback(port.close)
    link = BoardLink(
        port,
        clock,
        reply_timeout_s=settings.reply_timeout_s,
        give_up_wall_s=settings.give_up_wall_s,
    )
    losses = LossTally()
    board = BoardSession(link, link.hello(), settings, clock, losses)
    hear_every_joint(joints, clock, settings.can_timeout_s)
    board.prepare()
    _check_same_sensors(board, journal)
    range_v = _input_range_v(settings)
    contradicted = _contradictions(board, settings, range_v)
    outbox.put(
        BoardFound(
            port=settings.board_port, dictionary=board.found.dictionary, channel_mask=board.mask
        )
    )
    earlier = journal.earlier
    session_id = earlier.header.session_id if earlier else settings.session_id
    session_id = session_id or secrets.token_hex(8)
    writer = _open_journal(settings, session_id, board, clock, journal, stack)
    if settings.sensor_memory is not None:
        today = datetime.now(UTC).date().isoformat()
        remember_sensors(settings.sensor_memory, board.channels, range_v, today)
    board.start()
    hits = earlier.hits if earlier else ()
    loop = SessionLoop(
        settings=settings,
        clock=clock,
        board=board,
        joints=joints,
        losses=losses,
        journal=writer,
        outbox=outbox,
        state=session_machine.begin(settings.plan, hits, earlier.marks if earlier else ()),
        accepted_before=tuple(
            (hit.number, hit.posture, roving_point(settings.plan, hit))
            for hit in hits
            if hit.verdict.accepted
        ),
        polarities_before={
            hit.number: hit.verdict.polarity for hit in hits if hit.verdict.accepted
        },
        arm=arm_with_moves(settings.arm, earlier.marks) if earlier else None,
        next_hit=hits[-1].number + 1 if hits else 1,
        turn_s=_turn_wall_s(settings) * settings.time_scale,
    )
    outbox.put(
        SessionOpened(
            session_id=session_id,
            journal=str(writer.path),
            hits_before=len(hits),
            warnings=earlier.warnings if earlier else (),
        )
    )
    _note_sensors(loop, board, clock)
    for said in board.notes:
        loop.note(said, clock.now_s())
    for said in contradicted:
        loop.note(f"{CALIBRATION}{said}; confirmed by the operator", clock.now_s())
    # What is there now stays to the end: the collector need not look at it again and again. What an
    # earlier session of this process left out, and nobody holds any more, goes first.
    gc.unfreeze()
    gc.collect()
    gc.freeze()
    cpu_before_s = time.process_time()
    try:
        _loop(loop, board, joints, channel, clock, _turn_wall_s(settings))
    except ArmodalError as error:
        writer.begin_ending()
        with suppress(JournalError):
            loop.interrupt(str(error))
        raise
    writer.begin_ending()
    taken = _stop(loop, board, clock)
    reason = loop.ended or ""
    writer.append(encode_end(End(reason=reason, host_s=clock.now_s())))
    return Finished(
        complete=loop.complete,
        reason=reason,
        journal=str(writer.path),
        accepted=loop.hits.accepted + sum(hit.verdict.accepted for hit in hits),
        rejected=loop.hits.rejected + sum(not hit.verdict.accepted for hit in hits),
        cpu_s=time.process_time() - cpu_before_s,
        previews_dropped=outbox.previews_dropped,
        samples_taken=taken,
        samples_seen=board.stream.samples,
    )


def _stop(loop: SessionLoop, board: BoardSession, clock: Clock) -> int | None:
    """Stop the board and return the samples it took; what it counted to the last is kept."""
    taken = None
    try:
        taken = board.stop().next_sample
    except (BoardRefusedError, DeviceLostError, DeviceTimeoutError, FrameError) as error:
        loop.note(f"what the board lost at the very end is not known: {error}", clock.now_s())
    loop.flush_losses()
    return taken


def _loop(
    loop: SessionLoop,
    board: BoardSession,
    joints: JointSource,
    channel: Connection[Any, Any],
    clock: Clock,
    turn_wall_s: float,
) -> None:
    """One turn after the other; bytes gather between turns, so that few turns move many."""
    polled = joints.fileno() < 0
    waited_on = [board.fileno(), channel.fileno()] + ([] if polled else [joints.fileno()])
    turn_s = turn_wall_s / clock.wall_s(1.0)
    begun_s = clock.now_s()
    while loop.ended is None:
        while board.waits_for_reply and clock.now_s() - begun_s < turn_s:
            # A prompt reader makes round trips short; all else can wait for the turn.
            readable = bool(clock.wait([board.fileno()], turn_wall_s))
            board.turn(clock.now_s(), readable=readable)
        clock.sleep(begun_s + turn_s - clock.now_s())
        ready = clock.wait(waited_on, turn_wall_s if polled else IDLE_WALL_S)
        begun_s = now_s = clock.now_s()
        if polled or joints.fileno() in ready:
            joints.collect(now_s)
        board.turn(now_s, readable=board.fileno() in ready)
        loop.turn(now_s, _commands(channel) if channel.fileno() in ready else ())


def _commands(channel: Connection[Any, Any]) -> tuple[Command, ...]:
    """Return what has been said; nobody there any more is a word to stop."""
    said: list[Command] = []
    try:
        while channel.poll(0):
            command = channel.recv()
            if isinstance(command, Command):
                said.append(command)
    except (EOFError, OSError):
        said.append(Stop(reason=GONE, finish_hit=True))
    return tuple(said)


def _turn_wall_s(settings: AcquisitionSettings) -> float:
    return TURN_WALL_S if settings.time_scale <= 1.0 else FAST_TURN_WALL_S


def _check_journal_name(path: Path) -> None:
    if path.suffix.lower() == ".h5":
        raise JournalError(
            f"{path}: wanted the name of a journal, as {path.with_suffix('.journal').name}; .h5 is "
            "the session file's, which is made of the journal and would take its place"
        )


def _resume(settings: AcquisitionSettings, journal: _Journal, stack: ExitStack) -> None:
    """Open the journal to go on with, if it belongs to this arm and plan."""
    writer, earlier = go_on(settings.journal, mirror=settings.mirror, files=journal.files)
    stack.callback(writer.close)
    header = earlier.header
    for what, theirs, ours, name in (
        ("arm", header.arm.sha256, settings.arm.sha256, settings.arm.name),
        ("plan", header.plan.sha256, settings.plan.sha256, settings.plan.name),
    ):
        if theirs != ours:
            had = header.arm.name if what == "arm" else header.plan.name
            raise JournalError(
                f"{settings.journal} is a session of {what} {had} (sha256 {theirs[:12]}), not of "
                f"{name} (sha256 {ours[:12]}): give the files it was begun with, or begin another "
                "session"
            )
    had, has = (
        "measured" if told is None else f"told by hand to {math.degrees(told):g} deg"
        for told in (header.told_tolerance_rad, settings.told_tolerance_rad)
    )
    if had != has:
        raise JournalError(
            f"{settings.journal} is a session of joint angles {had}, and now they would be {has}: "
            "the two are never mixed; go on as it was begun, or begin another session"
        )
    journal.writer, journal.earlier = writer, earlier


def _check_same_sensors(board: BoardSession, journal: _Journal) -> None:
    """Refuse to mix hits of different sensors or scales in one journal."""
    if journal.earlier is None:
        return
    header = journal.earlier.header
    if header.dictionary_bytes != board.found.dictionary_bytes or header.channel_mask != board.mask:
        raise JournalError(
            f"the session was begun with board {header.dictionary.board_id}, and this one, "
            f"{board.found.dictionary.board_id}, describes itself differently (sensors, scales or "
            "supply): connect the same sensors, or begin another session"
        )


def _input_range_v(settings: AcquisitionSettings) -> float | None:
    """Return the largest input voltage, if it is known."""
    if settings.input_range_v is None and is_front_end(settings.board_port):
        return load_front_end(Path(settings.board_port)).range_v
    return settings.input_range_v


def _contradictions(
    board: BoardSession, settings: AcquisitionSettings, range_v: float | None
) -> list[str]:
    """Return what sensors say otherwise than the board, or were known by before.

    It is refused until somebody has confirmed it.
    """
    said = [text for c in board.channels for text in contradictions(c, range_v)]
    if settings.sensor_memory is not None:
        said += unlike_before(board.channels, range_v, load_sensors(settings.sensor_memory))
    if said and not settings.teds_confirmed:
        raise BoardRefusedError(
            f"{'; '.join(said)}: mount the sensors that the board describes, or correct its "
            "description; to measure all the same, give --accept-teds"
        )
    return said


def _open_journal(
    settings: AcquisitionSettings,
    session_id: str,
    board: BoardSession,
    clock: Clock,
    journal: _Journal,
    stack: ExitStack,
) -> JournalWriter | MirroredJournal:
    if journal.writer is not None:
        mark = Mark(kind=MarkKind.RESUMED, posture=None, point=None, host_s=clock.now_s())
        journal.writer.append(encode_mark(mark))
        return journal.writer
    header = SessionHeader(
        session_id=session_id,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        software=settings.software,
        arm=settings.arm,
        plan=settings.plan,
        dictionary=board.found.dictionary,
        dictionary_bytes=board.found.dictionary_bytes,
        channel_mask=board.mask,
        time_scale=settings.time_scale,
        told_tolerance_rad=settings.told_tolerance_rad,
        measured_by=settings.measured_by,
    )
    journal.writer = begin(settings.journal, header, mirror=settings.mirror, files=journal.files)
    stack.callback(journal.writer.close)
    return journal.writer


def _note_sensors(loop: SessionLoop, board: BoardSession, clock: Clock) -> None:
    for sensor in board.channels:
        if sensor.iepe in {IepeState.OPEN, IepeState.SHORT}:
            loop.note(
                f"the board finds the sensor circuit of {sensor.name} {sensor.iepe.name.lower()}: "
                "check sensor and cable",
                clock.now_s(),
            )
