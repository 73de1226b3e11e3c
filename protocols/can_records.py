"""One classic CAN frame, from whichever adapter it came."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CanFrame"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CanFrame:
    """A classic CAN data frame, or a remote frame (which carries no data)."""

    can_id: int  # 11 bits, or 29 where extended
    extended: bool
    data: bytes  # at most 8
    remote: bool = False
