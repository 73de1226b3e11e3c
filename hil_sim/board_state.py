"""The board's firmware: the C library of `protocols/c`, given a clock, a converter and a line.

Commands, capture, preview and framing are all in C, so that what is tested here is what runs on a
microcontroller. Python is the porting layer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.clock import DeviceClock, SampleClock
from armodal.protocols.board.dictionary import encode_dictionary
from armodal.protocols.board.records import BoardDictionary, BoardState, IepeState
from armodal.protocols.c.library import device_library

__all__ = ["BoardFirmware", "Converter"]

CONVERTER_HZ = 51_200  # the converter makes this rate and its whole fractions
LARGEST_DIVISOR = 512
BLOCK_RECORDS = 1024  # blocks held at the same time, however short
PREVIEW_FRAMES = 32
TRANSMIT_BYTES = 2095  # any frame with its delimiters

Counts = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True, kw_only=True)
class Converter:
    """How the firmware starts, stops and reads the converter."""

    start: Callable[[Fraction], None]
    stop: Callable[[], None]
    read: Callable[[int], Counts]


class BoardFirmware:
    """A board of the device library, without its line.

    Parameters
    ----------
    receive_bytes
        Size of the buffer for commands; None takes the smallest allowed. A board passes over what
        is longer, and answers it with BAD_VALUE where it fits.

    Attributes
    ----------
    dictionary : BoardDictionary
        How the board describes itself at present.
    send : callable
        Takes the bytes of one frame and returns whether the line took them.
    spoil : callable
        Takes the converter's counts and returns what a faulty channel makes of them.

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
        clock: DeviceClock,
        converter: Converter,
        receive_bytes: int | None = None,
    ) -> None:
        self._ffi, self._library = device_library()
        # By default the smallest allowed: what a board may pass over, this one does.
        self._receive_bytes = receive_bytes or int(self._library.AB_RECEIVE_BYTES)
        self._clock = clock
        self._converter = converter
        self._sampling: SampleClock | None = None
        self._error: BaseException | None = None
        self.send: Callable[[bytes], bool] = lambda _frame: False
        self.spoil: Callable[[Counts], Counts] = lambda counts: counts
        self.dictionary = dictionary
        self._bytes = encode_dictionary(dictionary)
        self._config, self._memory = self._make_config(dictionary)
        self._board = self._ffi.new("ab_board *")
        self._keep = self._ffi.from_buffer(self._bytes)
        self._check(
            self._library.ab_init(self._board, self._config, self._keep, len(self._bytes), session)
        )

    # The porting layer

    def _make_config(self, dictionary: BoardDictionary) -> tuple[Any, list[Any]]:
        ffi, n_channels = self._ffi, len(dictionary.channels)
        config = ffi.new("ab_config *")
        count_bytes = 192 * n_channels if n_channels <= 10 else 2040
        memory = [
            ffi.new("uint8_t[]", dictionary.block_capacity),
            ffi.new("ab_block[]", BLOCK_RECORDS),
            ffi.new("uint8_t[]", self._receive_bytes),
            ffi.new("uint8_t[]", TRANSMIT_BYTES),
            ffi.new("uint8_t[]", PREVIEW_FRAMES * (18 + count_bytes)),
        ]
        config.block_buffer, config.blocks = memory[0], memory[1]
        config.receive, config.transmit, config.preview = memory[2:]
        config.block_buffer_size, config.n_blocks = len(memory[0]), len(memory[1])
        config.receive_size, config.transmit_size, config.preview_size = map(len, memory[2:])
        calls: dict[str, tuple[str, Callable[..., Any]]] = {
            "send": ("size_t(void *, const uint8_t *, size_t)", self._send),
            "ticks": ("uint64_t(void *)", lambda _context: self._clock.ticks()),
            "rate": ("bool(void *, uint32_t, uint32_t, char *, size_t)", self._rate),
            "start": ("void(void *, uint32_t, uint32_t)", self._start),
            "stop": ("void(void *)", lambda _context: self._converter.stop()),
        }
        for name, (signature, function) in calls.items():
            callback = ffi.callback(signature, function, onerror=self._note_error)
            setattr(config.port, name, callback)
            memory.append(callback)
        return config, memory

    def _send(self, _context: Any, data: Any, size: int) -> int:
        return size if self.send(bytes(self._ffi.buffer(data, size))) else 0

    def _rate(
        self, _context: Any, numerator: int, denominator: int, reason: Any, size: int
    ) -> bool:
        refused = _rate_refusal(Fraction(numerator, denominator)).encode()[: size - 1]
        self._ffi.memmove(reason, refused + b"\x00", len(refused) + 1)
        return not refused

    def _start(self, _context: Any, numerator: int, denominator: int) -> None:
        rate_hz = Fraction(numerator, denominator)
        self._converter.start(rate_hz)
        self._sampling = SampleClock(
            rate_hz=rate_hz, tick_hz=self._clock.tick_hz, start_ticks=self._clock.ticks()
        )

    def _note_error(
        self, _kind: type[BaseException], error: BaseException, _trace: TracebackType
    ) -> None:
        self._error = self._error or error

    def _raise_noted(self) -> None:
        """Raise what went wrong in Python while C was running."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    # What the board's shell calls

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

    def reboot(self, session: int) -> None:
        """Begin anew, idle, with nothing held."""
        if self.running:
            self._converter.stop()
        self._sampling = None
        self._check(
            self._library.ab_init(self._board, self._config, self._keep, len(self._bytes), session)
        )

    def jump_clock(self, by_s: float) -> None:
        """Let the tick counter jump; samples come as before, at other ticks."""
        by = max(round(by_s * self._clock.tick_hz), -self._clock.offset_ticks)
        self._clock = replace(self._clock, offset_ticks=self._clock.offset_ticks + by)
        if self._sampling is not None:
            self._sampling = replace(self._sampling, start_ticks=self._sampling.start_ticks + by)

    def drift_clock(self, by_ppm: float) -> None:
        """Let the clock, and the converter on it, run faster from now on."""
        clock = self._clock
        self._clock = replace(
            clock,
            boot_s=clock.lab.now_s(),
            offset_ticks=clock.ticks(),
            error_ppm=clock.error_ppm + by_ppm,
        )

    def set_dictionary(self, dictionary: BoardDictionary) -> None:
        """Describe the board from now on; the hash in every frame follows."""
        encoded = encode_dictionary(dictionary)
        keep = self._ffi.from_buffer(encoded)
        self._check(self._library.ab_set_dictionary(self._board, keep, len(encoded)))
        self.dictionary, self._bytes, self._keep = dictionary, encoded, keep

    def open_sensor(self, channel: int) -> None:
        """The supply of a channel's sensor has opened: the dictionary says so (section 5)."""
        channels = list(self.dictionary.channels)
        channels[channel] = replace(channels[channel], iepe=IepeState.OPEN)
        self.set_dictionary(replace(self.dictionary, channels=tuple(channels)))

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

    def samples_due(self) -> int:
        """How many samples are ready and not yet read."""
        if self._sampling is None or not self.running:
            return 0
        return max(0, self._sampling.due(self._clock.ticks()) - self.next_sample)

    def take_samples(self, count: int) -> None:
        """Read samples from the converter and hand them to the library."""
        if self._sampling is None or not self.running:
            return
        counts = np.ascontiguousarray(self.spoil(self._converter.read(count)), dtype=np.int32)
        ticks = self._sampling.ready_ticks(self.next_sample)
        data = self._ffi.from_buffer("int32_t[]", counts)
        self._library.ab_samples(self._board, data, len(counts), ticks)
        self._raise_noted()

    def lose_samples(self, count: int) -> None:
        """The converter loses samples: the index jumps (section 8)."""
        if self.running:
            self._converter.read(count)
            self._library.ab_lost(self._board, count)

    def _check(self, result: int) -> None:
        if result == self._library.AB_INIT_DICTIONARY:
            raise ValueError(
                "the device library refuses the dictionary: wanted one that section 5 allows, "
                "with as many channels as at boot"
            )
        if result == self._library.AB_INIT_BUFFERS:
            raise ValueError("the device library wants larger buffers for this dictionary")


def _rate_refusal(rate_hz: Fraction) -> str:
    """Why the converter does not make a rate; empty where it does."""
    divisor = CONVERTER_HZ / rate_hz
    if divisor.denominator == 1 and 1 <= divisor <= LARGEST_DIVISOR:
        return ""
    below = min(max(1, int(divisor)), LARGEST_DIVISOR)
    above = min(below + 1, LARGEST_DIVISOR)
    near = " and ".join(f"{CONVERTER_HZ}/{d}" for d in sorted({below, above}))
    return f"rate {rate_hz} Hz cannot be made exactly: the nearest are {near} Hz"
