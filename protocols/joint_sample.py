"""One word of a controller on its joints, by whatever way it came."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["JointSample"]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSample:
    """Angles of all joints, base first, at the controller's own time.

    timestamp_s : None where the controller tells no time
    drive_state : None where it tells none
    """

    timestamp_s: float | None
    joints_rad: tuple[float, ...]
    drive_state: int | None
    held: bool
