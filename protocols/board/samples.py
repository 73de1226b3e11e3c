"""Sample counts on the wire: 24 bit, little endian, two's complement, sample by sample."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.board.records import BYTES_PER_COUNT
from armodal.protocols.errors import FrameError

__all__ = ["BYTES_PER_COUNT", "COUNT_MAX", "COUNT_MIN", "pack_counts", "unpack_counts"]

COUNT_MIN = -(1 << 23)
COUNT_MAX = (1 << 23) - 1

_WIDE = np.dtype("<i4")


def pack_counts(counts: npt.NDArray[np.int32]) -> bytes:
    """Pack counts, all channels of a sample together.

    Parameters
    ----------
    counts : (n_samples, n_channels) int32
        Between `COUNT_MIN` and `COUNT_MAX`.

    Raises
    ------
    FrameError
        If the array is not two-dimensional or a count needs more than 24 bits.
    """
    if counts.ndim != 2:
        raise FrameError(f"counts must be (n_samples, n_channels), got shape {counts.shape}")
    if counts.size and (counts.min() < COUNT_MIN or counts.max() > COUNT_MAX):
        raise FrameError(
            f"counts must lie in {COUNT_MIN}...{COUNT_MAX}, got "
            f"{counts.min()}...{counts.max()}: clip them as the converter does"
        )
    wide = np.ascontiguousarray(counts, dtype=_WIDE)
    return wide.view(np.uint8).reshape(-1, 4)[:, :BYTES_PER_COUNT].tobytes()


def unpack_counts(data: bytes, n_channels: int, offset: int = 0) -> npt.NDArray[np.int32]:
    """Unpack counts from `data`, starting at byte `offset`.

    Returns
    -------
    (n_samples, n_channels) int32
        Counts.

    Raises
    ------
    FrameError
        If the bytes are not a whole number of samples.
    """
    if n_channels < 1:
        raise FrameError(f"samples have at least one channel, got {n_channels}")
    stride = BYTES_PER_COUNT * n_channels
    n_samples, left = divmod(len(data) - offset, stride)
    if left or n_samples < 0:
        raise FrameError(
            f"{len(data) - offset} bytes are no whole number of samples of {stride} bytes"
        )
    if n_samples == 0:
        return np.empty((0, n_channels), dtype=np.int32)
    if offset == 0:
        data, offset = b"\x00" + data, 1
    # Each 32-bit word starts one byte early: the count fills its upper three bytes, and the
    # arithmetic shift drops the foreign byte and carries the sign.
    words: npt.NDArray[np.int32] = np.ndarray(
        (n_samples, n_channels),
        dtype=_WIDE,
        buffer=data,
        offset=offset - 1,
        strides=(stride, BYTES_PER_COUNT),
    )
    return words >> 8
