"""A board of the device library in this process; whoever makes it is its porting layer.

Commands, capture, preview and framing are all in C, as on a microcontroller. The simulated board
runs on it, and every front end that is no board of ours becomes one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.board.dictionary import encode_dictionary
from armodal.protocols.board.messages import encode_payload
from armodal.protocols.board.records import BoardDictionary, BoardState, ReplyCode
from armodal.protocols.c.library import device_library

__all__ = ["DeviceBoard", "PortingLayer"]

BLOCK_RECORDS = 1024  # blocks held at the same time, however short
PREVIEW_FRAMES = 32
TRANSMIT_BYTES = 2095  # any frame with its delimiters


@dataclass(frozen=True, slots=True, kw_only=True)
class PortingLayer:
    """What the library calls.

    send : takes the bytes of a frame, returns whether the line took them
    ticks : the board's clock
    rate_refusal : why the converter does not make a rate in Hz; empty where it does
    start, stop : the converter
    answer : to a command that the library does not know, by its type and payload: the record of its
        answer, or None where the board does not know it either
    """

    send: Callable[[bytes], bool]
    ticks: Callable[[], int]
    rate_refusal: Callable[[Fraction], str]
    start: Callable[[Fraction], None]
    stop: Callable[[], None]
    answer: Callable[[int, bytes], object | None] = lambda _type, _payload: None


class DeviceBoard:
    """A board after boot.

    Parameters
    ----------
    dictionary
        How it describes itself.
    session
        Random number of this boot, not 0.
    layer
        Line, clock and converter.
    receive_bytes
        Size of the buffer for commands; None takes the smallest allowed. A board passes over what
        is longer, and answers it with BAD_VALUE where it fits.
    preview_frames
        Frames of the preview that may wait for the line.

    Raises
    ------
    CompilerError
        If the library is not compiled and cannot be.
    ValueError
        If the library refuses the dictionary, or the buffer is too small for a command.
    """

    def __init__(
        self,
        dictionary: BoardDictionary,
        *,
        session: int,
        layer: PortingLayer,
        receive_bytes: int | None = None,
        preview_frames: int = PREVIEW_FRAMES,
    ) -> None:
        self._ffi, self._library = device_library()
        self._layer = layer
        self._error: BaseException | None = None
        self.dictionary = dictionary
        self._bytes = encode_dictionary(dictionary)
        receive_bytes = receive_bytes or int(self._library.AB_RECEIVE_BYTES)
        self._config, self._memory = self._make_config(dictionary, receive_bytes, preview_frames)
        self._board = self._ffi.new("ab_board *")
        self._keep = self._ffi.from_buffer(self._bytes)
        self.boot(session)

    def _make_config(
        self, dictionary: BoardDictionary, receive_bytes: int, preview_frames: int
    ) -> tuple[Any, list[Any]]:
        ffi, n_channels = self._ffi, len(dictionary.channels)
        config = ffi.new("ab_config *")
        count_bytes = 192 * n_channels if n_channels <= 10 else 2040
        memory = [
            ffi.new("uint8_t[]", dictionary.block_capacity),
            ffi.new("ab_block[]", BLOCK_RECORDS),
            ffi.new("uint8_t[]", receive_bytes),
            ffi.new("uint8_t[]", TRANSMIT_BYTES),
            ffi.new("uint8_t[]", preview_frames * (18 + count_bytes)),
        ]
        config.block_buffer, config.blocks = memory[0], memory[1]
        config.receive, config.transmit, config.preview = memory[2:]
        config.block_buffer_size, config.n_blocks = len(memory[0]), len(memory[1])
        config.receive_size, config.transmit_size, config.preview_size = map(len, memory[2:])
        calls: dict[str, tuple[str, Callable[..., Any]]] = {
            "send": ("size_t(void *, const uint8_t *, size_t)", self._send),
            "ticks": ("uint64_t(void *)", lambda _context: self._layer.ticks()),
            "rate": ("bool(void *, uint32_t, uint32_t, char *, size_t)", self._rate),
            "start": ("void(void *, uint32_t, uint32_t)", self._start),
            "stop": ("void(void *)", lambda _context: self._layer.stop()),
            "command": (
                "ab_code(void *, uint8_t, const uint8_t *, size_t, uint8_t *, char *, size_t)",
                self._command,
            ),
        }
        for name, (signature, function) in calls.items():
            callback = ffi.callback(signature, function, onerror=self._note_error)
            setattr(config.port, name, callback)
            memory.append(callback)
        return config, memory

    def _send(self, _context: Any, data: Any, size: int) -> int:
        return size if self._layer.send(bytes(self._ffi.buffer(data, size))) else 0

    def _rate(
        self, _context: Any, numerator: int, denominator: int, reason: Any, size: int
    ) -> bool:
        refused = self._layer.rate_refusal(Fraction(numerator, denominator)).encode()[: size - 1]
        self._ffi.memmove(reason, refused + b"\x00", len(refused) + 1)
        return not refused

    def _start(self, _context: Any, numerator: int, denominator: int) -> None:
        self._layer.start(Fraction(numerator, denominator))

    def _command(
        self, _context: Any, kind: int, payload: Any, n: int, answer: Any, _reason: Any, _size: int
    ) -> int:
        record = self._layer.answer(kind, bytes(self._ffi.buffer(payload, n)))
        if record is None:
            return ReplyCode.UNKNOWN_COMMAND
        told = encode_payload(record)
        self._ffi.memmove(answer, told, len(told))
        return ReplyCode.OK

    def _note_error(
        self, _kind: type[BaseException], error: BaseException, _trace: TracebackType
    ) -> None:
        self._error = self._error or error

    def _raise_noted(self) -> None:
        """Raise what went wrong in Python while C was running."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    @property
    def running(self) -> bool:
        """Whether samples are taken."""
        return int(self._board.state) == BoardState.RUNNING

    @property
    def next_sample(self) -> int:
        """Samples taken since START."""
        return int(self._board.next_sample)

    @property
    def session(self) -> int:
        """Number in every frame's header since the board began."""
        return int(self._board.session)

    @property
    def triggers_missed(self) -> int:
        """Triggers without a free buffer and blocks given up, since START."""
        return int(self._board.triggers_missed)

    @property
    def adc_overruns(self) -> int:
        """Times the converter lost samples, since START."""
        return int(self._board.adc_overruns)

    def boot(self, session: int) -> None:
        """Begin anew, idle, with nothing held."""
        self._check(
            self._library.ab_init(self._board, self._config, self._keep, len(self._bytes), session)
        )

    def set_dictionary(self, dictionary: BoardDictionary) -> None:
        """Describe the board from now on; the hash in every frame follows."""
        encoded = encode_dictionary(dictionary)
        keep = self._ffi.from_buffer(encoded)
        self._check(self._library.ab_set_dictionary(self._board, keep, len(encoded)))
        self.dictionary, self._bytes, self._keep = dictionary, encoded, keep

    def receive(self, data: bytes) -> int:
        """Take bytes from the host; return how many, fewer where the line is busy."""
        taken = int(self._library.ab_receive(self._board, data, len(data)))
        self._raise_noted()
        return taken

    def poll(self) -> bool:
        """Send what waits; return whether something is left because the line is busy."""
        left = bool(self._library.ab_poll(self._board))
        self._raise_noted()
        return left

    def samples(self, counts: npt.NDArray[np.int32], ticks: int) -> None:
        """Hand samples over, (n, n_channels) counts, the first of them ready at `ticks`."""
        counts = np.ascontiguousarray(counts, dtype=np.int32)
        data = self._ffi.from_buffer("int32_t[]", counts)
        self._library.ab_samples(self._board, data, len(counts), ticks)
        self._raise_noted()

    def lost(self, count: int) -> None:
        """The converter lost samples: the index jumps (section 8 of the protocol)."""
        self._library.ab_lost(self._board, count)

    def _check(self, result: int) -> None:
        if result == self._library.AB_INIT_DICTIONARY:
            raise ValueError(
                "the device library refuses the dictionary: wanted one that section 5 allows, "
                "with as many channels as at boot"
            )
        if result == self._library.AB_INIT_BUFFERS:
            raise ValueError("the device library wants larger buffers for this dictionary")
