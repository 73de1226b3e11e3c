"""One word of a controller on its joints, by whatever way it came."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["JointSample"]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSample:
    """Angles of all joints, base first, at the controller's own time.

    timestamp_s : None where the controller tells no time
    drive_state : None where it tells none
    held : whether drives or brakes hold the arm; a controller that does not say so is believed to
    """

    joints_rad: tuple[float, ...]
    timestamp_s: float | None = None
    drive_state: int | None = None
    held: bool = True
