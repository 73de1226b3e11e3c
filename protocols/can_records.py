"""One CAN frame, from whichever adapter it came."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CLASSIC_BYTES", "CanFrame", "bytes_carried"]

CLASSIC_BYTES = 8
# ISO 11898-1:2015, table 5: what the data length codes above 8 stand for.
_FD_BYTES = (12, 16, 20, 24, 32, 48, 64)


@dataclass(frozen=True, slots=True, kw_only=True)
class CanFrame:
    """A data frame, classic or CAN FD, or a classic remote frame (which carries no data)."""

    can_id: int  # 11 bits, or 29 where extended
    extended: bool
    data: bytes  # at most 8, of an FD frame at most 64
    remote: bool = False
    fd: bool = False


def bytes_carried(length: int, *, fd: bool) -> int:
    """How many data bytes a frame has that carries a message of `length` bytes, 0 to 64.

    An FD frame of more than 8 bytes is filled up to the next of the lengths there are.
    """
    if not fd or length <= CLASSIC_BYTES:
        return length
    return next(carried for carried in _FD_BYTES if carried >= length)
