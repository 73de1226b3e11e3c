"""A sound file (.wav) replayed at its own rate, as if a device were sampling now."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.daq.front_end.source import Chunk, to_counts
from armodal.protocols.errors import DeviceLostError, FrontEndError
from armodal.protocols.foreign.wav import wav_variables
from armodal.protocols.front_end import FrontEnd
from armodal.protocols.os_words import os_words

__all__ = ["DRIVER", "Replay"]

LARGEST_BYTES = 2**30


class Replay:
    """A file as a device: it begins at START and is lost at its end.

    Raises
    ------
    FrontEndError, ForeignFileError
        If the file cannot be read, or lacks an input.
    """

    driver = "replay of a file"

    teds: tuple[bytes, ...] = ()

    def __init__(self, front_end: FrontEnd) -> None:
        self._path = Path(front_end.source)
        self._counts, self._rate_hz = _read(self._path, front_end.inputs)
        self._begun_s = 0.0
        self._at: int | None = None

    def rate_refusal(self, rate_hz: Fraction) -> str:
        """Return why it is not the file's own rate."""
        if rate_hz == self._rate_hz:
            return ""
        return f"{self._path.name} was recorded at {self._rate_hz} Hz"

    def start(self, rate_hz: Fraction, now_s: float) -> None:
        """Begin at the file's first sample."""
        del rate_hz
        self._begun_s, self._at = now_s, 0

    def stop(self) -> None:
        """Replay no more."""
        self._at = None

    def read(self, now_s: float) -> list[Chunk]:
        """Return the samples whose time has come."""
        first = self._at
        if first is None:
            return []
        due = int((now_s - self._begun_s) * self._rate_hz) + 1
        if first == len(self._counts):
            raise DeviceLostError(
                f"{self._path.name} has come to its end, after "
                f"{len(self._counts) / self._rate_hz:.3g} s; resume the session to replay it again"
            )
        self._at = min(due, len(self._counts))
        if self._at == first:
            return []
        ready_s = self._begun_s + first / self._rate_hz
        return [Chunk(counts=self._counts[first : self._at], ready_s=ready_s)]

    def close(self) -> None:
        """Do nothing."""


def _read(path: Path, inputs: tuple[int | str, ...]) -> tuple[npt.NDArray[np.int32], int]:
    """Return counts (n, n_channels) and the rate, Hz."""
    try:
        size = path.stat().st_size
        data = path.read_bytes() if size <= LARGEST_BYTES else b""
    except OSError as error:
        raise FrontEndError(
            f"{path.name}: wanted a sound file beside the front-end file, it cannot be read "
            f"({os_words(error)}); check its name"
        ) from error
    if size > LARGEST_BYTES:
        raise FrontEndError(f"{path.name}: wanted at most 1 GiB, got {size} bytes; cut the file")
    (found,) = wav_variables(data, path.name)
    numbers = [int(number) for number in inputs]
    if max(numbers) > len(found.variables):
        raise FrontEndError(
            f"{path.name} has {len(found.variables)} channels, the front-end file names input "
            f"{max(numbers)}; correct one of them"
        )
    if found.axis is None or not len(found.variables[0].values):
        raise FrontEndError(f"{path.name} has no samples; save it again")
    columns = [to_counts(found.variables[number - 1].values) for number in numbers]
    return np.column_stack(columns), round(1.0 / found.axis.step)


DRIVER = Replay
