"""A hammer that does not hit along the direction recorded."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from armodal.hil_sim.effects.compared import Compared, TrueEffect
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.from_file import of_the_test
from armodal.hil_sim.effects.hidden import Hidden, Hides, about, hidden, plain, unit
from armodal.hil_sim.newton_euler import rotation
from armodal.hil_sim.sensing import Sensing
from armodal.hil_sim.truth import Vector

if TYPE_CHECKING:
    from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["COMPARED", "HIDES", "OF_FILE", "HitDirection"]

HIT_DEG = 12.0


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


def hide(places: ArmPlaces, rng: np.random.Generator, magnitude: float) -> Hidden:
    """All hits turned alike, about an axis across the first posture's."""
    wanted = places.study.plan.postures[0].hit_direction
    across = np.cross(np.array([0.0, 0.0, 1.0]) if wanted is None else wanted, unit(rng))
    degrees = HIT_DEG * magnitude * about(rng)
    turn = degrees * across / np.linalg.norm(across)
    table = {"kind": "hit_direction", "turn_deg": plain(turn)}
    return hidden("hit_direction", "hammer", table, turn_deg=list(plain(turn)))


def _first_turn(true: TrueEffect) -> float:
    return float(np.deg2rad(true.parameters["turn_deg"][0]))


OF_FILE = {"hit_direction": of_the_test}
COMPARED = {"hit_direction": Compared(size=_first_turn)}
HIDES = {"hit_direction": Hides(hide=hide, since=2)}
