"""How board and bus do, for the operator's screen."""

from __future__ import annotations

from armodal.daq.board_session import BoardSession
from armodal.daq.events import Health
from armodal.daq.joint_source import JointSource

__all__ = ["HEALTH_EVERY_WALL_S", "health_of"]

HEALTH_EVERY_WALL_S = 1.0


def health_of(board: BoardSession | None, joints: JointSource | None) -> Health:
    """Return the state of what is there; a device that is not counts as nothing received."""
    uncertainty_s, rate_ppm = board.health_of_clock if board else (None, None)
    return Health(
        clock_uncertainty_s=uncertainty_s,
        clock_rate_ppm=rate_ppm,
        board=board.status if board else None,
        can_frames=joints.joints.frames if joints else 0,
        can_faults=joints.faults if joints else 0,
        stream_samples=board.stream.samples if board else 0,
    )
