"""What a channel makes of its quantity, in the words of a sensor's certificate."""

from __future__ import annotations

import math

from armodal.protocols.board.records import Channel

__all__ = ["sensitivity_words"]


def sensitivity_words(channel: Channel, input_range_v: float | None) -> str:
    """Return the sensitivity that a channel's counts are turned into its unit by.

    A board tells the largest magnitude of a channel in its unit; with the voltage of that magnitude
    the sensitivity follows. Where the voltage is not known, it is told what one count (ct) means.

    Parameters
    ----------
    channel
        As the board's dictionary describes it.
    input_range_v
        Largest voltage of the board's inputs; None where it is not known.
    """
    unit = channel.unit.replace("^2", "²")
    if input_range_v is None:
        return f"{channel.scale:.3g} {unit}/ct"
    sensitivity_mv = math.copysign(1e3 * input_range_v / channel.full_scale, channel.scale)
    return f"{sensitivity_mv:.4g} mV/{f'({unit})' if '/' in unit else unit}"
