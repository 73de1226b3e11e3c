"""A laboratory whose board reboots at a certain request to it, or prompt of the operator."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from support.virtual_lab import VirtualLab

from armodal.daq.events import Prompted
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board.codec import FrameDecoder
from armodal.protocols.board.records import FrameType

ANOTHER = 4321  # session of the board behind its reboot


class RebootingLab(VirtualLab):
    """As `VirtualLab`; counts requests to the board and prompts, and reboots the board at one.

    A request at which it reboots is lost.

    Attributes
    ----------
    moments : list
        The kind of each request or prompt.
    """

    def __init__(self, *args: Any, at_moment: int | None, **named: Any) -> None:
        super().__init__(*args, **named)
        self.moments: list[FrameType | PromptKind] = []
        self.at_moment = at_moment

    def surroundings(self) -> Any:
        """As of any laboratory, the board's line and the operator's watched."""
        return replace(
            super().surroundings(),
            open_board=lambda _settings: _Watched(self._opened(self.board_line), self),
            make_outbox=lambda _channel: _Told(self.operator, self),
        )

    def take(self, moment: FrameType | PromptKind) -> None:
        """Count a moment; reboot if it is the one."""
        self.moments.append(moment)
        if len(self.moments) - 1 == self.at_moment:
            self.board_line.to_device.clear()
            self.firmware.reboot(ANOTHER)


class _Watched:
    """The host's end of the board's line, requests read on their way."""

    def __init__(self, end: Any, lab: RebootingLab) -> None:
        self._end = end
        self._lab = lab
        self._decoder = FrameDecoder()
        self.name = end.name

    def fileno(self) -> int:
        return int(self._end.fileno())

    def read(self) -> bytes:
        return bytes(self._end.read())

    def write(self, data: bytes) -> None:
        self._end.write(data)
        for frame in self._decoder.feed(data):
            self._lab.take(frame.header.type)

    def close(self) -> None:
        self._end.close()


class _Told:
    """The operator's end of the events, prompts read on their way."""

    previews_dropped = 0

    def __init__(self, operator: Any, lab: RebootingLab) -> None:
        self._operator = operator
        self._lab = lab

    def put(self, event: Any) -> None:
        if isinstance(event, Prompted):
            self._lab.take(event.prompt.kind)
        self._operator.put(event)

    def finish(self, timeout_s: float) -> bool:
        return bool(self._operator.finish(timeout_s))
