"""How large an effect must be to be clear, case by case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError

from armodal.hil_sim.study.catalogue import Maker
from armodal.hil_sim.study.model_error import Tables
from armodal.hil_sim.study.places import ArmPlaces, Hidden
from armodal.hil_sim.study.prominence import Bystander
from armodal.protocols.errors import PlantError

__all__ = ["Sized", "clear_place", "clear_size"]

WANTED, MOST = 3.0, 4.0  # times the floor
AIM = 3.4
LARGEST = 4.0  # times the size at the top of the makers' files: beyond, another place is drawn
TRIALS, PLACES = 7, 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Sized:
    """A place with the size at which the effect is clear there."""

    size: float  # times the maker's own
    place: int  # number of the draw
    stands_out: float  # held-out error at that size, times the floor


def clear_size(
    make: Maker,
    places: ArmPlaces,
    bystander: Bystander,
    with_effect: Callable[[Hidden], Tables],
    stream: Callable[[int], np.random.Generator],
) -> Sized:
    """Find the smallest size at which the effect stands out three times above the floor.

    Some places hide an effect at any size, such as an axis in line with a joint: there another
    place is drawn. After four of them the one where it stood out most is taken as it is.

    Parameters
    ----------
    with_effect
        Tables of the arm with what is hidden.
    stream
        Random numbers of a place's draw, always the same for the same number.
    """
    best = Sized(size=1.0, place=0, stands_out=0.0)
    for place in range(PLACES):
        found = _at(make, places, bystander, with_effect, stream, place)
        if found.stands_out >= WANTED:
            return found
        if found.stands_out > best.stands_out:
            best = found
    return best


def clear_place(
    make: Maker,
    places: ArmPlaces,
    bystander: Bystander,
    with_effect: Callable[[Hidden], Tables],
    stream: Callable[[int], np.random.Generator],
) -> Sized:
    """Find a place where the maker's own size stands out: a channel that hardly moves does not."""
    best = Sized(size=1.0, place=0, stands_out=0.0)
    for place in range(PLACES):
        hidden = make(places, stream(place), 1.0)
        stands_out = bystander.stands_out(with_effect(hidden))
        if stands_out > best.stands_out:
            best = Sized(size=1.0, place=place, stands_out=stands_out)
        if stands_out >= WANTED:
            break
    return best


def _at(
    make: Maker,
    places: ArmPlaces,
    bystander: Bystander,
    with_effect: Callable[[Hidden], Tables],
    stream: Callable[[int], np.random.Generator],
    place: int,
) -> Sized:
    """Search one place: the error above the floor grows about as the size does."""
    size, low, high, largest = 0.5, 0.0, np.inf, LARGEST
    best = Sized(size=LARGEST, place=place, stands_out=0.0)
    for _ in range(TRIALS):
        try:
            stands_out = bystander.stands_out(with_effect(make(places, stream(place), size)))
        except (PlantError, ValidationError):  # no arm can have so much of it
            if size <= low:
                return best
            largest = 0.5 * (low + size)
            size = largest
            continue
        if stands_out >= WANTED:
            high = size
            best = Sized(size=size, place=place, stands_out=stands_out)
            if stands_out <= MOST:
                return best
        else:
            low = size
            if best.stands_out < WANTED and stands_out > best.stands_out:
                best = Sized(size=size, place=place, stands_out=stands_out)
            if size >= largest:
                return best
        above = max(stands_out**2 - 1.0, 1e-6)
        size *= float(np.clip(np.sqrt((AIM**2 - 1.0) / above), 1.0 / 6.0, 4.0))
        if not low < size < high:
            size = np.sqrt(low * high) if low > 0.0 else 0.4 * high
        size = min(size, largest)
    return best
