"""The board's firmware: the C library of `protocols/c`, given a clock, a converter and a line.

Commands, capture, preview and framing are all in C, so that what is tested here is what runs on a
microcontroller. Python is the porting layer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.clock import DeviceClock, SampleClock
from armodal.protocols.board.records import BoardDictionary, IepeState
from armodal.protocols.c.device_board import DeviceBoard, PortingLayer

__all__ = ["BoardFirmware", "Converter"]

CONVERTER_HZ = 51_200  # the converter makes this rate and its whole fractions
LARGEST_DIVISOR = 512

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
        As of `DeviceBoard`, which raises likewise.

    Attributes
    ----------
    dictionary : BoardDictionary
        How the board describes itself at present.
    send : callable
        Takes the bytes of one frame and returns whether the line took them.
    spoil : callable
        Takes the converter's counts and returns what a faulty channel makes of them.
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
        self._clock = clock
        self._converter = converter
        self._sampling: SampleClock | None = None
        self.send: Callable[[bytes], bool] = lambda _frame: False
        self.spoil: Callable[[Counts], Counts] = lambda counts: counts
        self._board = DeviceBoard(
            dictionary,
            session=session,
            layer=PortingLayer(
                send=self._send,
                ticks=self._ticks,
                rate_refusal=_rate_refusal,
                start=self._start,
                stop=converter.stop,
            ),
            receive_bytes=receive_bytes,
        )

    def _send(self, frame: bytes) -> bool:
        return self.send(frame)  # as it is by then

    def _ticks(self) -> int:
        return self._clock.ticks()  # of the clock as it is by then

    def _start(self, rate_hz: Fraction) -> None:
        self._converter.start(rate_hz)
        self._sampling = SampleClock(
            rate_hz=rate_hz, tick_hz=self._clock.tick_hz, start_ticks=self._clock.ticks()
        )

    @property
    def dictionary(self) -> BoardDictionary:
        """How the board describes itself at present."""
        return self._board.dictionary

    @property
    def running(self) -> bool:
        """Whether samples are taken."""
        return self._board.running

    @property
    def next_sample(self) -> int:
        """Samples taken since START."""
        return self._board.next_sample

    @property
    def session(self) -> int:
        """Number in every frame's header since the board began."""
        return self._board.session

    @property
    def triggers_missed(self) -> int:
        """Triggers without a free buffer and blocks given up, since START."""
        return self._board.triggers_missed

    @property
    def adc_overruns(self) -> int:
        """Times the converter lost samples, since START."""
        return self._board.adc_overruns

    def reboot(self, session: int) -> None:
        """Begin anew, idle, with nothing held."""
        if self.running:
            self._converter.stop()
        self._sampling = None
        self._board.boot(session)

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
        self._board.set_dictionary(dictionary)

    def open_sensor(self, channel: int) -> None:
        """The supply of a channel's sensor has opened: the dictionary says so (section 5)."""
        channels = list(self.dictionary.channels)
        channels[channel] = replace(channels[channel], iepe=IepeState.OPEN)
        self.set_dictionary(replace(self.dictionary, channels=tuple(channels)))

    def receive(self, data: bytes) -> int:
        """Take bytes from the host; return how many, fewer where the line is busy."""
        return self._board.receive(data)

    def poll(self) -> bool:
        """Send what waits; return whether something is left because the line is busy."""
        return self._board.poll()

    def samples_due(self) -> int:
        """How many samples are ready and not yet read."""
        if self._sampling is None or not self.running:
            return 0
        return max(0, self._sampling.due(self._clock.ticks()) - self.next_sample)

    def take_samples(self, count: int) -> None:
        """Read samples from the converter and hand them to the library."""
        if self._sampling is None or not self.running:
            return
        counts = self.spoil(self._converter.read(count))
        self._board.samples(counts, self._sampling.ready_ticks(self.next_sample))

    def lose_samples(self, count: int) -> None:
        """The converter loses samples: the index jumps (section 8)."""
        if self.running:
            self._converter.read(count)
            self._board.lost(count)


def _rate_refusal(rate_hz: Fraction) -> str:
    """Why the converter does not make a rate; empty where it does."""
    divisor = CONVERTER_HZ / rate_hz
    if divisor.denominator == 1 and 1 <= divisor <= LARGEST_DIVISOR:
        return ""
    below = min(max(1, int(divisor)), LARGEST_DIVISOR)
    above = min(below + 1, LARGEST_DIVISOR)
    near = " and ".join(f"{CONVERTER_HZ}/{d}" for d in sorted({below, above}))
    return f"rate {rate_hz} Hz cannot be made exactly: the nearest are {near} Hz"
