"""A hammer that does not hit along the direction recorded."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.newton_euler import rotation
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Vector

__all__ = ["OF_FILE", "HitDirection"]


class HitDirection(BaseEffect):
    """Every hit's direction turned by a rotation vector, base axes."""

    kind: Literal["hit_direction"]
    turn_deg: Vector

    def sense(self, sensing: Sensing) -> Sensing:
        """Turn the hits."""
        turn = np.deg2rad(self.turn_deg)
        angle = float(np.linalg.norm(turn))
        if angle == 0.0:
            return sensing
        return replace(sensing, hit_turn=rotation(turn / angle, angle) @ sensing.hit_turn)


OF_FILE = {"hit_direction": of_the_test}
