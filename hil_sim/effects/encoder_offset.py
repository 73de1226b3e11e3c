"""An encoder whose zero is not where the model has it."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.sensing import Sensing

__all__ = ["EncoderOffset"]


class EncoderOffset(BaseEffect):
    """The encoder reads `offset_deg` more than the joint's true angle."""

    kind: Literal["encoder_offset"]
    joint: str
    offset_deg: float

    def sense(self, sensing: Sensing) -> Sensing:
        """Shift the joint."""
        offsets = dict(sensing.encoder_rad)
        offsets[self.joint] = offsets.get(self.joint, 0.0) + float(np.deg2rad(self.offset_deg))
        return replace(sensing, encoder_rad=offsets)
