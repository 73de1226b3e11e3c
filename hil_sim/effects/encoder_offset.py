"""An encoder whose zero is not where the model has it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import FileEffect, Twin
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden
from armodal.hil_sim.sensing import Sensing

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "EncoderOffset"]

ENCODER_DEG = 4.0


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


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """One of the joints whose angle matters."""
    joint = str(rng.choice(list(places.joints)[1:5] or list(places.joints)))
    offset = float(rng.choice([-1.0, 1.0]) * ENCODER_DEG * magnitude * about(rng))
    table = {"kind": "encoder_offset", "joint": joint, "offset_deg": offset}
    return hidden("encoder_offset", joint, table, offset_deg=offset)


def _beyond_reading(true: TrueEffect) -> float:
    return -float(np.deg2rad(true.parameters["offset_deg"]))


def _others(true: TrueEffect) -> float:
    """Return the ordinary errors of the same encoder."""
    if "plant" not in true.case:
        return -float(true.case["encoder_offsets_rad"][true.place])
    tables = true.case["plant"]["effects"]
    same = [e for e in tables if e["kind"] == "encoder_offset" and e["joint"] == true.place]
    total = sum(e["offset_deg"] for e in same)
    return -float(np.deg2rad(total - true.parameters["offset_deg"]))


OF_FILE = {"encoder_offset": _of_file}
COMPARED = {"encoder_offset": Compared(size=_beyond_reading, beside=_others)}
HIDES = {"encoder_offset": Hides(hide=hide, since=1, sized=True)}
