"""Which axis of the roving sensor each acceleration channel measures."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.protocols.board.records import Channel
from armodal.protocols.errors import EstimateError

__all__ = ["axis_letter", "sensor_axes"]

_LETTERS = "xyz"


def axis_letter(channel: Channel) -> str:
    """Last letter of a channel's name where it is x, y or z; else empty."""
    last = channel.name[-1:].lower()
    return last if last in _LETTERS else ""


def sensor_axes(channels: Sequence[Channel]) -> tuple[int, ...]:
    """Axis of the sensor, 0 to 2, that each acceleration channel measures.

    The channels' names tell, or, where no name of three does, their order: x, y, z.

    Raises
    ------
    EstimateError
        If the names leave an axis open or tell one twice.
    """
    letters = [axis_letter(channel) for channel in channels]
    if len(letters) == len(_LETTERS) and not any(letters):
        letters = list(_LETTERS)
    if not all(letters) or len(set(letters)) != len(letters):
        raise EstimateError(
            "wanted acceleration channels of one sensor, at most one for each of its axes, with "
            "names that end in x, y or z such as acc_z (three with no such name are x, y, z in "
            f"order); got {', '.join(channel.name for channel in channels)}; name the board's "
            "channels so, and record those of the roving sensor only"
        )
    return tuple(_LETTERS.index(letter) for letter in letters)
