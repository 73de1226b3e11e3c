"""Controllers and buses with one fault each: healthy slcan lines, altered on their way.

`BROKEN_CONTROLLERS` names them. They serve to show that `armodal check can` finds what it looks
for. The identifiers and bytes are those of `armodal_controller.dbc`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import PlantError
from armodal.protocols.slcan import SlcanParser, encode_slcan

__all__ = ["BROKEN_CONTROLLERS", "BrokenController", "broken_controller"]

FIRST, SECOND, THIRD = 0x301, 0x302, 0x303
PER_CYCLE = 3
HEALTHY_FLAGS = b"F00\r"
NO_ACKNOWLEDGE_FLAGS = b"FA4\r"  # bus error, error passive, error warning


class BrokenController:
    """A controller without a fault; the faults override `frame` or `other`."""

    def __init__(self) -> None:
        self._tail = b""
        self.n_frames = 0  # so far, the one in hand not counted

    @property
    def cycle(self) -> int:
        """Cycles so far."""
        return self.n_frames // PER_CYCLE

    def to_device(self, data: bytes) -> bytes:
        """Leave the host's commands as they are."""
        return data

    def to_host(self, data: bytes) -> bytes:
        """Alter the adapter's lines."""
        *lines, self._tail = (self._tail + data).split(b"\r")
        return b"".join(self._altered(line + b"\r") for line in lines)

    def _altered(self, line: bytes) -> bytes:
        (item,) = SlcanParser().feed(line) or (None,)
        if not isinstance(item, CanFrame):
            return self.other(line)
        sent = self.frame(item)
        self.n_frames += 1
        return sent

    def frame(self, frame: CanFrame) -> bytes:
        """Return the lines sent for a frame."""
        return line_of(frame)

    def other(self, line: bytes) -> bytes:
        """Return the line sent for an answer of the adapter."""
        return line


def line_of(frame: CanFrame, **changed_bytes: int) -> bytes:
    """Return the line of a frame; `b7=3` makes its byte 7 a 3."""
    data = bytearray(frame.data)
    for name, value in changed_bytes.items():
        data[int(name[1:])] = value
    return encode_slcan(frame.can_id, bytes(data), extended=frame.extended)


class Alone(BrokenController):
    """No node acknowledges: one frame is repeated for ever, the adapter sees errors."""

    def __init__(self) -> None:
        super().__init__()
        self._first: CanFrame | None = None

    def frame(self, frame: CanFrame) -> bytes:
        """Repeat the first frame."""
        self._first = self._first or frame
        return 4 * line_of(self._first)

    def other(self, line: bytes) -> bytes:
        """Raise the flags."""
        return NO_ACKNOWLEDGE_FLAGS if line == HEALTHY_FLAGS else line


class HalfRate(BrokenController):
    """Only every second cycle is sent, and the counter counts those."""

    def frame(self, frame: CanFrame) -> bytes:
        """Leave out odd cycles."""
        return b"" if self.cycle % 2 else line_of(frame, b7=self.cycle // 2 % 256)


class SkipsFrames(BrokenController):
    """Every fortieth frame is lost."""

    def frame(self, frame: CanFrame) -> bytes:
        """Leave one out."""
        return b"" if self.n_frames % 40 == 39 else line_of(frame)


class Bursts(BrokenController):
    """Forty cycles at a time."""

    def __init__(self) -> None:
        super().__init__()
        self._held = b""

    def frame(self, frame: CanFrame) -> bytes:
        """Hold it until the burst is full."""
        self._held += line_of(frame)
        if self.n_frames % (40 * PER_CYCLE) != 40 * PER_CYCLE - 1:
            return b""
        burst, self._held = self._held, b""
        return burst


class StuckCounter(BrokenController):
    """The counter stands still."""

    def frame(self, frame: CanFrame) -> bytes:
        """Overwrite it."""
        return line_of(frame, b7=17)


class FallsSilent(BrokenController):
    """After a hundred cycles nothing more is sent."""

    def frame(self, frame: CanFrame) -> bytes:
        """Send it in the beginning."""
        return line_of(frame) if self.cycle < 100 else b""


class Shaky(BrokenController):
    """Joint 1 jumps by 0.2 degree from cycle to cycle."""

    def frame(self, frame: CanFrame) -> bytes:
        """Move joint 1."""
        if frame.can_id != FIRST:
            return line_of(frame)
        raw = int.from_bytes(frame.data[:3], "little", signed=True) + 2000 * (self.cycle % 2)
        low, middle, high = raw.to_bytes(3, "little", signed=True)
        return line_of(frame, b0=low, b1=middle, b2=high)


class OutOfRange(BrokenController):
    """Joint 2 is told to be at 300 degrees."""

    def frame(self, frame: CanFrame) -> bytes:
        """Move joint 2."""
        if frame.can_id != FIRST:
            return line_of(frame)
        low, middle, high = (3_000_000).to_bytes(3, "little", signed=True)
        return line_of(frame, b3=low, b4=middle, b5=high)


class NotAvailable(BrokenController):
    """The angle of joint 4 is said not to be available."""

    def frame(self, frame: CanFrame) -> bytes:
        """Take the angle of joint 4 away."""
        return line_of(frame, b3=0, b4=0, b5=0x80) if frame.can_id == SECOND else line_of(frame)


class UnknownState(BrokenController):
    """The drive state is a reserved one."""

    def frame(self, frame: CanFrame) -> bytes:
        """Overwrite the state."""
        return line_of(frame, b6=9)


class MissingMessage(BrokenController):
    """The message of joints 5 and 6 has another identifier."""

    def frame(self, frame: CanFrame) -> bytes:
        """Move it."""
        return line_of(replace(frame, can_id=0x313) if frame.can_id == THIRD else frame)


class TornLines(BrokenController):
    """Every fiftieth line of the adapter has lost its middle."""

    def frame(self, frame: CanFrame) -> bytes:
        """Tear it."""
        line = line_of(frame)
        return line[:6] + line[9:] if self.n_frames % 50 == 49 else line


BROKEN_CONTROLLERS: dict[str, Callable[[], BrokenController]] = {
    "alone": Alone,
    "bursts": Bursts,
    "falls-silent": FallsSilent,
    "half-rate": HalfRate,
    "missing-message": MissingMessage,
    "not-available": NotAvailable,
    "out-of-range": OutOfRange,
    "shaky": Shaky,
    "skips-frames": SkipsFrames,
    "stuck-counter": StuckCounter,
    "torn-lines": TornLines,
    "unknown-state": UnknownState,
}


def broken_controller(name: str) -> BrokenController:
    """Return the broken controller of a name.

    Raises
    ------
    PlantError
        If there is none of this name.
    """
    if name not in BROKEN_CONTROLLERS:
        known = ", ".join(BROKEN_CONTROLLERS)
        raise PlantError(f"wanted a broken controller there is ({known}), got {name!r}")
    return BROKEN_CONTROLLERS[name]()
