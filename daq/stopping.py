"""When a session may end that was told to: not while a hit may still be on its way."""

from __future__ import annotations

from dataclasses import dataclass

from armodal.daq.commands import Stop

__all__ = ["Stopping", "begin_stopping"]

HOPE_WALL_S = 0.15  # for the processes at both ends of the line


@dataclass(frozen=True, slots=True, kw_only=True)
class Stopping:
    """A stop that was asked for, and the lab time at which waiting ends."""

    reason: str
    finish_hit: bool
    until_s: float

    def may_end(self, now_s: float, *, hit_under_way: bool) -> bool:
        """Whether nothing is worth waiting for any more."""
        return not self.finish_hit or now_s >= self.until_s or not hit_under_way


def begin_stopping(
    earlier: Stopping | None, command: Stop, now_s: float, *, record_s: float, wall_s: float
) -> Stopping:
    """Return what a stop leads to; a repeated one never makes the waiting longer.

    The board announces a hit when its record is full, so one that has just begun is not known of
    yet: only a record's length, and as long again for its transfer, show that there is none.

    Parameters
    ----------
    record_s
        Length of a record, lab seconds.
    wall_s
        Wall seconds a lab second lasts.
    """
    if earlier is not None and command.finish_hit:
        return earlier
    return Stopping(
        reason=command.reason,
        finish_hit=command.finish_hit,
        until_s=now_s + 2.0 * record_s + HOPE_WALL_S / wall_s,
    )
