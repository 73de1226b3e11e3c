"""The conversation with the board: commands and their replies, and the frames that come unasked.

The protocol is specified in `docs/board-protocol.md`. Waiting is done only before the run;
while it lasts, replies come back in the same list as data and nothing blocks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from armodal.daq.clock import Clock, waits
from armodal.daq.clock_fit import RoundTrip
from armodal.daq.serial_port import BytePort
from armodal.protocols.board.codec import (
    PROTOCOL_VERSION,
    FrameDecoder,
    encode_frame,
)
from armodal.protocols.board.messages import (
    decode_answer,
    decode_dictionary,
    decode_reply,
    dictionary_hash,
    encode_payload,
    join_hello,
)
from armodal.protocols.board.records import (
    BoardDictionary,
    BoardState,
    BoardStatus,
    Configuration,
    Frame,
    FrameType,
    Header,
    ReplyCode,
)
from armodal.protocols.board.sequence import (
    SequenceTracker,
)
from armodal.protocols.errors import (
    BoardRefusedError,
    DeviceLostError,
    DeviceTimeoutError,
    FrameError,
)

FoundT = TypeVar("FoundT")

__all__ = ["BoardLink", "FoundBoard", "Reply"]

TRIES = 3
# The processes of host and simulation do not run faster when the laboratory's clock does.
SHORTEST_WALL_TIMEOUT_S = 0.25
GIVE_UP_WALL_S = 3.0  # a loaded machine holds up a process for so long
HELD_FRAMES = 4096
HELD_COMMANDS = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundBoard:
    """The board as HELLO found it."""

    dictionary: BoardDictionary
    dictionary_bytes: bytes
    dictionary_hash: int
    session: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """A reply frame with the command it answers and the times around it."""

    frame: Frame
    sent_s: float
    received_s: float

    @property
    def trip(self) -> RoundTrip:
        """Return the round trip it makes for the clock fit."""
        return RoundTrip(
            sent_s=self.sent_s, received_s=self.received_s, ticks=self.frame.header.ticks
        )


class BoardLink:
    """Requests and replies over one line.

    Parameters
    ----------
    port
        The line, owned by the caller.
    clock
        The laboratory's clock.
    reply_timeout_s
        Lab seconds to wait for a reply before the command is sent again, three times in all.
    give_up_wall_s
        Seconds of the waiting process that a command is given at least, with all its repetitions.

    Attributes
    ----------
    received_bytes : int
        Bytes received.
    """

    def __init__(
        self,
        port: BytePort,
        clock: Clock,
        *,
        reply_timeout_s: float = 0.5,
        give_up_wall_s: float = GIVE_UP_WALL_S,
    ) -> None:
        self._port = port
        self._clock = clock
        self._wait_wall_s = max(clock.wall_s(reply_timeout_s), SHORTEST_WALL_TIMEOUT_S)
        self._give_up_wall_s = max(TRIES * self._wait_wall_s, give_up_wall_s)
        self._decoder = FrameDecoder()
        self._found: FoundBoard | None = None
        self._sequence = 0
        self._tag = 0
        self._sequences = SequenceTracker()
        self._sent: dict[int, tuple[float, float]] = {}  # tag: lab time, wall time
        self._held: list[Frame] = []
        self._lost: DeviceLostError | None = None  # to be raised once what came before is out
        self.received_bytes = 0

    @property
    def frames_lost(self) -> int:
        """Frames missing by their sequence number since HELLO."""
        return self._sequences.missing

    @property
    def bad_frames(self) -> int:
        """Stretches on the line that were no valid frame."""
        return self._decoder.bad_frames

    @property
    def frames(self) -> int:
        """Valid frames received."""
        return self._decoder.frames

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._port.fileno()

    def hello(self) -> FoundBoard:
        """Ask the board to describe itself, and hold it to that from here on.

        Raises
        ------
        DeviceTimeoutError
            If nothing answers, or what answers is no board.
        FrameError
            If the board's description cannot be read.
        """
        fragments: dict[int, list[bytes]] = {}

        def whole(frame: Frame) -> bytes | None:
            if frame.header.type is not FrameType.HELLO_REPLY:
                return None
            pieces = fragments.setdefault(frame.header.tag, [])
            pieces.append(frame.payload)
            return join_hello(pieces)

        frame, data = self._ask(FrameType.HELLO, b"", whole)
        header = frame.header
        if dictionary_hash(data) != header.dictionary_hash:
            raise FrameError(
                f"the board on {self._port.name} describes itself with a dictionary of hash "
                f"{dictionary_hash(data):04x} but says {header.dictionary_hash:04x}: its firmware "
                "is at fault"
            )
        self._found = FoundBoard(
            dictionary=decode_dictionary(data),
            dictionary_bytes=data,
            dictionary_hash=header.dictionary_hash,
            session=header.session,
        )
        self._sequences = SequenceTracker()
        self._held.clear()
        return self._found

    def configure(self, configuration: Configuration) -> None:
        """Set rate, channels, trigger and block; BoardRefusedError with the board's reason."""
        self.request(FrameType.CONFIGURE, encode_payload(configuration))

    def start(self) -> None:
        """Start sampling; a repeated START that finds the board running is none the worse."""
        self._held.clear()
        code, reason = decode_reply(self._exchange(FrameType.START).frame.payload)
        if code is ReplyCode.WRONG_STATE and self.status()[0].state is BoardState.RUNNING:
            return
        self._accept(FrameType.START, code, reason)

    def stop(self) -> None:
        """Stop sampling; complete blocks stay held."""
        self.request(FrameType.STOP)

    def status(self) -> tuple[BoardStatus, RoundTrip]:
        """Ask for the board's state and counts, and wait for them."""
        reply = self._exchange(FrameType.STATUS)
        return decode_answer(BoardStatus, reply.frame.payload), reply.trip

    def request(self, kind: FrameType, payload: bytes = b"") -> Reply:
        """Send a command and wait for its OK.

        Raises
        ------
        BoardRefusedError
            If the board refuses, with its reason.
        DeviceTimeoutError
            If it does not answer three times.
        DeviceLostError
            If it is gone, has rebooted, or describes itself differently.
        """
        reply = self._exchange(kind, payload)
        self._accept(kind, *decode_reply(reply.frame.payload))
        return reply

    def send(self, kind: FrameType, payload: bytes = b"") -> int:
        """Send a command without waiting and return its tag."""
        self._tag = self._tag % 0xFFFF + 1
        if len(self._sent) >= HELD_COMMANDS:
            self._sent.pop(next(iter(self._sent)))
        found = self._found
        header = Header(
            type=kind,
            session=0 if found is None or kind is FrameType.HELLO else found.session,
            sequence=self._sequence,
            dictionary_hash=found.dictionary_hash if found else 0,
            tag=self._tag,
        )
        self._sequence = (self._sequence + 1) & 0xFFFFFFFF
        now_s = self._clock.now_s()
        self._sent[self._tag] = (now_s, self._clock.wall_s(now_s))
        self._port.write(encode_frame(header, payload))
        return self._tag

    def pump(self) -> list[Frame]:
        """Return the frames that have come; never waits.

        Raises
        ------
        DeviceLostError
            If the board is gone, has rebooted, or its dictionary has changed.
        """
        held, self._held = self._held, []
        return held + self._receive()

    def reply_of(self, frame: Frame) -> Reply | None:
        """Match a reply frame that `pump` has just returned with its command; None if unknown."""
        sent = self._sent.get(frame.header.tag)
        if sent is None:
            return None
        # The board answers in order: what was asked before has been answered or lost.
        self._sent = {tag: times for tag, times in self._sent.items() if times[1] > sent[1]}
        return Reply(frame=frame, sent_s=sent[0], received_s=self._clock.now_s())

    def waits_for_reply(self) -> bool:
        """Whether a command has not been answered yet."""
        return bool(self._sent)

    def check_alive(self) -> None:
        """Raise if the board is lost, or a command has waited for its reply three times too long.

        Raises
        ------
        DeviceLostError, DeviceTimeoutError
        """
        if self._lost is not None:
            raise self._lost
        if not self._sent:
            return
        oldest = next(iter(self._sent.values()))[1]
        if self._wall_s() - oldest > self._give_up_wall_s:
            raise DeviceTimeoutError(
                f"the board on {self._port.name} has stopped answering; check it, then resume"
            )

    def _exchange(self, kind: FrameType, payload: bytes = b"") -> Reply:
        answer = FrameType(kind | 0x80)

        def its_reply(frame: Frame) -> Reply | None:
            return self.reply_of(frame) if frame.header.type is answer else None

        return self._ask(kind, payload, its_reply)[1]

    def _ask(
        self, kind: FrameType, payload: bytes, find: Callable[[Frame], FoundT | None]
    ) -> tuple[Frame, FoundT]:
        """Send a command until a frame is what `find` looks for; keep the others for `pump`."""
        bytes_before, frames_before = self.received_bytes, self.frames
        give_up = self._wall_s() + self._give_up_wall_s
        for tried in range(1, TRIES + 1):
            self.send(kind, payload)
            until = self._wall_s() + self._wait_wall_s if tried < TRIES else give_up
            for left in waits(until, self._wall_s):
                if not self._clock.wait([self._port.fileno()], left):
                    break
                frames = self._receive()
                for index, frame in enumerate(frames):
                    found = find(frame)
                    if found is not None:
                        self._hold(frames[index + 1 :])
                        return frame, found
                    self._hold([frame])
                if self._lost is not None:
                    raise self._lost
        raise self._no_answer(kind, self.received_bytes - bytes_before, self.frames - frames_before)

    def _wall_s(self) -> float:
        """Seconds of the waiting process: patience with a reply is none of the laboratory's."""
        return self._clock.wall_s(self._clock.now_s())

    def _hold(self, frames: list[Frame]) -> None:
        self._held.extend(frames[: HELD_FRAMES - len(self._held)])

    def _receive(self) -> list[Frame]:
        data = self._port.read()
        self.received_bytes += len(data)
        frames = self._decoder.feed(data)
        found = self._found
        if found is None:
            return frames
        kept = []
        for frame in frames:
            self._lost = self._lost or self._another_board(found, frame.header)
            if self._lost is not None:
                break
            # A frame older than the one before is a repetition.
            if self._sequences.check(frame.header) >= 0:
                kept.append(frame)
        if self._lost is not None and not kept:
            raise self._lost
        return kept

    def _another_board(self, found: FoundBoard, header: Header) -> DeviceLostError | None:
        """Return why a frame is not of the board that HELLO found; None where it is."""
        if header.session != found.session:
            return DeviceLostError(
                f"the board on {self._port.name} has restarted (session {found.session:08x} "
                f"became {header.session:08x}): its blocks are gone; resume the session"
            )
        if header.dictionary_hash != found.dictionary_hash:
            return DeviceLostError(
                f"the board on {self._port.name} now describes itself differently (dictionary "
                f"hash {found.dictionary_hash:04x} became {header.dictionary_hash:04x}): a "
                "sensor or its supply has changed; check the sensors, then resume"
            )
        return None

    def _accept(self, kind: FrameType, code: ReplyCode, reason: str) -> None:
        if code is not ReplyCode.OK:
            raise BoardRefusedError(
                f"the board on {self._port.name} refused {kind.name}: "
                f"{code.name}{': ' + reason if reason else ''}"
            )

    def _no_answer(
        self, kind: FrameType, n_bytes: int, n_frames: int
    ) -> DeviceTimeoutError | FrameError:
        name = self._port.name
        if n_bytes == 0:
            return DeviceTimeoutError(
                f"the device on {name} did not answer {kind.name} in {TRIES} tries; is the board "
                "switched on, and is this its port?"
            )
        if n_frames == 0:
            return FrameError(
                f"the device on {name} answered {n_bytes} bytes, none of them a frame of the "
                f"armodal board protocol (version {PROTOCOL_VERSION}); is it the right port?"
                + (f" Last fault: {self._decoder.last_error}" if self._decoder.last_error else "")
            )
        return DeviceTimeoutError(
            f"the board on {name} sent {n_frames} frames but no answer to {kind.name} in {TRIES} "
            "tries; is its firmware for this protocol, and the line free of disturbance?"
        )
