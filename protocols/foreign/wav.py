"""Sound files (.wav): PCM of 8 to 32 bits and IEEE numbers, one channel beside the other.

A sound file has no unit: full scale is 1 here, and the manifest says what it means in N and
m/s^2.

References
----------
IBM and Microsoft, Multimedia Programming Interface and Data Specifications 1.0 (1991), ch. 3.
Microsoft, Multiple channel audio data and WAVE files (2007): WAVEFORMATEXTENSIBLE.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.bounds import MOST_NUMBERS
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.variables import Axis, Variable, Variables

__all__ = ["wav_variables"]

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_MOST_CHANNELS = 64
_KNOWN = {(_PCM, 8), (_PCM, 16), (_PCM, 24), (_PCM, 32), (_FLOAT, 32), (_FLOAT, 64)}


@dataclass(frozen=True, slots=True)
class _Format:
    code: int
    channels: int
    rate_hz: int
    bits: int


def wav_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the channels of a sound file, full scale 1.

    Raises
    ------
    ForeignFileError
        If it is truncated, compressed, or no sound file.
    """
    layout, samples = None, None
    at = 12
    while at + 8 <= len(data):
        name, size = struct.unpack_from("<4sI", data, at)
        if name == b"fmt " and size >= 16 and at + 8 + size <= len(data):
            layout = _format(data[at + 8 : at + 8 + size], origin)
        if name == b"data":
            if at + 8 + size > len(data):
                raise ForeignFileError(
                    f"{origin}: wanted {size} bytes of samples, as its header announces, got "
                    f"{len(data) - at - 8}: the file is truncated; save it again"
                )
            samples = memoryview(data)[at + 8 : at + 8 + size]
            break
        at += 8 + size + size % 2
    if layout is None or samples is None:
        raise ForeignFileError(
            f"{origin}: wanted a sound file with its format before its samples, got none: the file "
            "is truncated or damaged; save it again"
        )
    frame = layout.channels * layout.bits // 8
    n = len(samples) // frame
    if not n:
        raise ForeignFileError(
            f"{origin}: wanted a sound file with samples, got none; save it again"
        )
    if n * layout.channels > MOST_NUMBERS:
        raise ForeignFileError(
            f"{origin}: wanted at most {MOST_NUMBERS} samples, got {n * layout.channels}; split "
            "the file"
        )
    table = _numbers(samples[: n * frame], layout).reshape(n, layout.channels)
    return (
        Variables(
            origin=origin,
            format=f"sound file of {layout.bits} bits",
            variables=tuple(
                Variable(name=f"column {i + 1}", values=column, unit="full scale")
                for i, column in enumerate(table.T)
            ),
            named=False,
            axis=Axis(unit="s", first=0.0, step=1.0 / layout.rate_hz),
        ),
    )


def _format(chunk: bytes, origin: str) -> _Format:
    code, channels, rate, _, _, bits = struct.unpack_from("<HHIIHH", chunk)
    if code == _EXTENSIBLE and len(chunk) >= 26:
        (code,) = struct.unpack_from("<H", chunk, 24)  # of the sub-format
    if (code, bits) not in _KNOWN or not 1 <= channels <= _MOST_CHANNELS or rate == 0:
        raise ForeignFileError(
            f"{origin}: wanted PCM or IEEE numbers of 1 to {_MOST_CHANNELS} channels, got format "
            f"{code}, {bits} bits, {channels} channels at {rate} Hz; save it uncompressed"
        )
    return _Format(code, channels, rate, bits)


def _numbers(samples: memoryview, layout: _Format) -> npt.NDArray[np.float64]:
    if layout.code == _FLOAT:
        return np.frombuffer(samples, dtype=f"<f{layout.bits // 8}").astype(np.float64)
    if layout.bits == 8:
        return (np.frombuffer(samples, dtype=np.uint8).astype(np.float64) - 128.0) / 128.0
    if layout.bits == 24:
        three = np.frombuffer(samples, dtype=np.uint8).reshape(-1, 3)
        four = np.zeros((len(three), 4), dtype=np.uint8)
        four[:, 1:] = three  # the sign bit stays where it is
        return four.view("<i4").reshape(-1).astype(np.float64) / 2.0**31
    numbers = np.frombuffer(samples, dtype=f"<i{layout.bits // 8}").astype(np.float64)
    return numbers / 2.0 ** (layout.bits - 1)
