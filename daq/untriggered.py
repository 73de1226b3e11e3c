"""Pushes that the stream shows and the trigger does not: a hammer of reversed polarity."""

from __future__ import annotations

import numpy as np

from armodal.daq.events import Preview
from armodal.daq.judge import force_column
from armodal.protocols.board.records import Channel
from armodal.protocols.plan_records import Trigger

__all__ = ["UntriggeredPushes"]

_CLEAR = 2.0  # trigger levels, as a hit has to have
_TIMES = 2  # seen so often, it is no cable that was touched


class UntriggeredPushes:
    """Watch the stream's force for pulses against the trigger's slope; tell of them once."""

    def __init__(self, channels: tuple[Channel, ...], trigger: Trigger) -> None:
        self._column = force_column(channels)
        self._scale = channels[self._column].scale * (1.0 if trigger.rising else -1.0)
        self._level_n = abs(trigger.level_n)
        self._seen = 0

    def told_by(self, preview: Preview) -> str:
        """Return what to tell the operator after this envelope; empty for nothing."""
        if self._seen >= _TIMES:
            return ""
        ends = np.stack([preview.lowest, preview.highest])[..., self._column] * self._scale
        ends = ends - np.median(ends)
        against, along = -float(ends.min()), float(ends.max())
        if against < _CLEAR * self._level_n or along >= self._level_n:
            return ""
        self._seen += 1
        if self._seen < _TIMES:
            return ""
        return (
            f"a force of {against:.3g} N against the trigger's slope came and recorded nothing: is "
            "the hammer's polarity reversed? Then turn trigger.slope in the plan"
        )
