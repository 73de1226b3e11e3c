"""The check's own end of a board's line: sends what it likes, keeps all that comes."""

from __future__ import annotations

from collections.abc import Callable

from armodal.daq.check.raw_frame import RawDecoder, RawFrame, encode_raw
from armodal.daq.clock import Clock, waits
from armodal.daq.clock_fit import RoundTrip
from armodal.daq.serial_port import BytePort
from armodal.protocols.board.codec import (
    PROTOCOL_VERSION,
)
from armodal.protocols.board.messages import (
    decode_answer,
    decode_reply,
    encode_payload,
)
from armodal.protocols.board.records import (
    BoardState,
    BoardStatus,
    Configuration,
    FrameType,
    ReplyCode,
)
from armodal.protocols.errors import DeviceTimeoutError, FrameError

__all__ = ["TRIES", "BoardProbe", "BoardStepError"]

TRIES = 3
REPLY_TIMEOUT_S = 0.5
PATIENCE_WALL_S = 1.0  # a loaded machine holds up a process for so long
# The least time a board and the host's driver are given to be done with something, wall seconds.
SETTLE_WALL_S = 0.05


class BoardStepError(FrameError):
    """The board answered otherwise than a step needs to go on."""


class BoardProbe:
    """Commands, and a record of every frame since `clear`.

    Attributes
    ----------
    frames : list of RawFrame
        In the order in which they came.
    session : int
        Session id that commands carry.
    received_bytes : int
        Bytes received in all.
    """

    def __init__(
        self, port: BytePort, clock: Clock, *, patience_wall_s: float = PATIENCE_WALL_S
    ) -> None:
        self.port = port
        self.clock = clock
        self._patience_wall_s = patience_wall_s
        self.frames: list[RawFrame] = []
        self.session = 0
        self.received_bytes = 0
        self._decoder = RawDecoder()
        self._sequence = 0
        self._tag = 0

    @property
    def faults(self) -> list[str]:
        """Why stretches since `clear` were no frames."""
        return self._decoder.faults

    def clear(self) -> None:
        """Forget the frames and faults so far."""
        self.frames = []
        self._decoder.faults.clear()

    def send(
        self,
        kind: int,
        payload: bytes = b"",
        *,
        session: int | None = None,
        version: int = PROTOCOL_VERSION,
    ) -> int:
        """Send a command and return its tag."""
        self._tag = self._tag % 0xFFFF + 1
        if session is None:
            session = 0 if kind == FrameType.HELLO else self.session
        self.port.write(
            encode_raw(
                kind,
                payload,
                session=session,
                sequence=self._sequence,
                tag=self._tag,
                version=version,
            )
        )
        self._sequence = (self._sequence + 1) & 0xFFFFFFFF
        return self._tag

    def collect(self, lab_s: float, enough: Callable[[], bool] | None = None) -> bool:
        """Read for some lab seconds, or until it is `enough`; return whether it was."""
        for left_s in waits(self.clock.now_s() + lab_s, self.clock.now_s):
            if enough is not None and enough():
                return True
            if self.clock.wait([self.port.fileno()], self.clock.wall_s(left_s)):
                self.read()
        return enough is not None and enough()

    def patience_s(self, lab_s: float) -> float:
        """Return lab seconds to wait for what takes `lab_s` at most; never too few for the host."""
        return max(lab_s, self._patience_wall_s / self.clock.wall_s(1.0))

    def settle(self) -> None:
        """Read what is still under way."""
        wall_s = max(SETTLE_WALL_S, self.clock.wall_s(SETTLE_WALL_S))
        self.collect(wall_s / self.clock.wall_s(1.0))

    def read(self) -> None:
        """Read what has come; never waits."""
        data = self.port.read()
        self.received_bytes += len(data)
        self.frames += self._decoder.feed(data, self.clock.now_s())

    def reply(
        self,
        kind: int,
        payload: bytes = b"",
        *,
        tries: int = TRIES,
        session: int | None = None,
        version: int = PROTOCOL_VERSION,
    ) -> RawFrame | None:
        """Send a command until its reply comes; None if it does not."""
        for _ in range(tries):
            seen = len(self.frames)
            tag = self.send(kind, payload, session=session, version=version)
            found: list[RawFrame] = []

            def answered(seen: int = seen, tag: int = tag, found: list[RawFrame] = found) -> bool:
                found += [f for f in self.frames[seen:] if f.tag == tag and f.type == kind | 0x80]
                return bool(found)

            if self.collect(self.patience_s(REPLY_TIMEOUT_S), answered):
                return found[0]
        return None

    def ask(self, kind: int, payload: bytes = b"", *, session: int | None = None) -> RawFrame:
        """Send a command and return its reply.

        Raises
        ------
        DeviceTimeoutError
            If no reply comes three times.
        """
        reply = self.reply(kind, payload, session=session)
        if reply is None:
            name = FrameType(kind).name if kind in set(FrameType) else f"type 0x{kind:02x}"
            raise DeviceTimeoutError(f"no answer to {name} in {TRIES} tries")
        return reply

    def code(
        self, kind: int, payload: bytes = b"", *, session: int | None = None
    ) -> tuple[ReplyCode, str]:
        """Send a command and return code and reason of its reply."""
        return decode_reply(self.ask(kind, payload, session=session).payload)

    def want_ok(self, kind: FrameType, payload: bytes = b"") -> None:
        """Send a command and hold the board to its OK.

        Raises
        ------
        BoardStepError
            If it refuses.
        """
        code, reason = self.code(kind, payload)
        if code is not ReplyCode.OK:
            raise BoardStepError(f"{kind.name} was refused: {code.name} {reason}".rstrip())

    def status(self) -> BoardStatus:
        """Ask for the board's state."""
        return self.status_trip()[0]

    def status_trip(self) -> tuple[BoardStatus, RoundTrip]:
        """Ask for the board's state, and note the times around its answer."""
        for _ in range(TRIES):
            sent_s = self.clock.now_s()
            reply = self.reply(FrameType.STATUS, tries=1)
            if reply is not None:
                trip = RoundTrip(sent_s=sent_s, received_s=reply.received_s, ticks=reply.ticks)
                return decode_answer(BoardStatus, reply.payload), trip
        raise DeviceTimeoutError(f"no answer to STATUS in {TRIES} tries")

    def begin(self, configuration: Configuration) -> None:
        """Configure, start, and forget what came before."""
        self.want_ok(FrameType.CONFIGURE, encode_payload(configuration))
        self.clear()
        code, reason = self.code(FrameType.START)
        lost_reply = code is ReplyCode.WRONG_STATE and self.status().state is BoardState.RUNNING
        if code is not ReplyCode.OK and not lost_reply:
            raise BoardStepError(f"START was refused: {code.name} {reason}".rstrip())

    def end(self) -> None:
        """Stop, and read what is still under way."""
        self.want_ok(FrameType.STOP)
        self.settle()
