"""An encoder whose zero is not where the model has it."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.sensing import Sensing

__all__ = ["OF_FILE", "EncoderOffset"]


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


def _of_file(own: FileEffect) -> Twin:
    """In the file it is what the joint stands beyond its reading."""
    place, off = own.effect.place, -float(np.rad2deg(own.sizes["encoder"]))
    table = {"kind": "encoder_offset", "joint": place, "offset_deg": off}
    return Twin(tables=[table], replaces=[("encoder_offset", place)])


OF_FILE = {"encoder_offset": _of_file}
