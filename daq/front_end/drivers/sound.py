"""A sound card as a device, for teaching: PortAudio by the package sounddevice."""

from __future__ import annotations

import importlib
from collections import deque
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.daq.front_end.source import Chunk
from armodal.daq.front_end.timing import SampleTimes
from armodal.protocols.errors import DeviceLostError, FrontEndError, MissingPackageError
from armodal.protocols.front_end import FrontEnd

__all__ = ["DRIVER", "SoundCard", "sound_package"]

MOST_WAITING = 4096  # blocks of the card that nobody has read


def sound_package() -> Any:
    """Return the package sounddevice, or raise MissingPackageError saying how to get it."""
    try:
        return importlib.import_module("sounddevice")
    except ImportError as error:
        raise MissingPackageError(
            "wanted the package sounddevice for a sound card, it is not installed; install it with "
            "`pip install 'armodal[sound]'`"
        ) from error
    except OSError as error:
        raise MissingPackageError(
            "wanted the library PortAudio for a sound card, it is not installed; on Debian and "
            "Ubuntu `apt install libportaudio2`"
        ) from error


class SoundCard:
    """An input of the computer's; what its converter makes is taken as 24 bits.

    Raises
    ------
    MissingPackageError, FrontEndError
        If PortAudio, the card or its channels are not there.
    """

    teds: tuple[bytes, ...] = ()

    def __init__(self, front_end: FrontEnd) -> None:
        self._sound = sound_package()
        self._columns = np.array([int(number) - 1 for number in front_end.inputs])
        self._n_inputs = int(self._columns.max()) + 1
        self._device = _device(front_end.source)
        self._blocks: deque[tuple[npt.NDArray[np.int32], float, bool]] = deque(maxlen=MOST_WAITING)
        self._stream: Any = None
        self._times: SampleTimes | None = None
        self._rate_hz = 0.0
        self._expected_s: float | None = None  # of the next block, by the card's clock
        try:
            found = self._sound.query_devices(self._device, "input")
        except (ValueError, self._sound.PortAudioError) as error:
            raise FrontEndError(
                f"front-end file {front_end.name}: source: wanted a sound card, got "
                f"{front_end.source!r}, which is none; `armodal devices` lists them"
            ) from error
        self.name = str(found["name"])
        self.driver = f"sounddevice {self._sound.__version__}"
        if found["max_input_channels"] < self._n_inputs:
            raise FrontEndError(
                f"{self.name} has {found['max_input_channels']} inputs, the front-end file names "
                f"input {self._n_inputs}; correct it, or take another card"
            )

    def rate_refusal(self, rate_hz: Fraction) -> str:
        """Return why the card does not make a rate."""
        if rate_hz.denominator != 1:
            return "a sound card makes whole rates only, such as 48000 Hz"
        try:
            self._sound.check_input_settings(
                device=self._device,
                channels=self._n_inputs,
                dtype="int32",
                samplerate=float(rate_hz),
            )
        except (ValueError, self._sound.PortAudioError):
            return f"{self.name} does not make {rate_hz} Hz; 44100 and 48000 Hz are usual"
        return ""

    def start(self, rate_hz: Fraction, now_s: float) -> None:
        """Open the card's stream."""
        self._blocks.clear()
        self._rate_hz, self._expected_s = float(rate_hz), None
        self._times = SampleTimes(self.name, self._rate_hz, now_s)
        try:
            self._stream = self._sound.InputStream(
                device=self._device,
                channels=self._n_inputs,
                dtype="int32",
                samplerate=self._rate_hz,
                callback=self._take,
            )
            self._stream.start()
        except self._sound.PortAudioError as error:
            raise DeviceLostError(
                f"{self.name} cannot be started: is another program using it?"
            ) from error

    def stop(self) -> None:
        """Close the card's stream."""
        stream, self._stream = self._stream, None
        if stream is not None:
            stream.close()

    def read(self, now_s: float) -> list[Chunk]:
        """Return the blocks that the card has brought."""
        times = self._times
        if self._stream is None or times is None:
            return []
        chunks = []
        while self._blocks:
            counts, at_s, overflowed = self._blocks.popleft()
            lost = self._lost(at_s, overflowed)
            times.lost(lost)
            chunks.append(Chunk(counts=counts, ready_s=times.add(len(counts), now_s), lost=lost))
            self._expected_s = at_s + len(counts) / self._rate_hz
        if not chunks:
            times.check(now_s)
        return chunks

    def close(self) -> None:
        """Let go of the card."""
        self.stop()

    def _lost(self, at_s: float, overflowed: bool) -> int:
        """Samples between two blocks, by the card's clock, where the card says that some are."""
        if not overflowed:
            return 0
        late_s = 0.0 if self._expected_s is None else at_s - self._expected_s
        return max(round(late_s * self._rate_hz), 1)

    def _take(self, samples: npt.NDArray[np.int32], _frames: int, time: Any, status: Any) -> None:
        """Called by PortAudio's own thread."""
        counts = samples[:, self._columns] >> 8  # of 32 bits, the upper 24
        self._blocks.append((counts, float(time.inputBufferAdcTime), bool(status.input_overflow)))


def _device(source: str) -> int | str | None:
    if not source:
        return None
    return int(source) if source.isdigit() else source


DRIVER = SoundCard
