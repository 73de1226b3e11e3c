"""How large an effect must be to be clear, case by case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError

from armodal.protocols.errors import PlantError

__all__ = ["AS_MADE", "Sized", "clear_place", "clear_size"]

WANTED, MOST = 3.0, 4.0  # times the floor
AIM = 3.4
LARGEST = 4.0  # times the size at the top of the makers' files: beyond, another place is drawn
TRIALS, PLACES = 7, 4

StandsOut = Callable[[int, float], float]
"""Held-out error, times the floor, of an effect at a place (number of the draw) in a size."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sized:
    """A place with the size at which the effect is clear there."""

    size: float  # times the maker's own
    place: int  # number of the draw
    stands_out: float  # held-out error at that size, times the floor


AS_MADE = Sized(size=1.0, place=0, stands_out=0.0)


def clear_size(stands_out: StandsOut) -> Sized:
    """Find the smallest size at which the effect stands out three times above the floor.

    Some places hide an effect at any size, such as an axis in line with a joint: there another
    place is drawn. After four of them the one where it stood out most is taken as it is.
    """
    return _first_clear(lambda place: _at(stands_out, place))


def clear_place(stands_out: StandsOut) -> Sized:
    """Find a place where the maker's own size stands out: a channel that hardly moves does not."""
    return _first_clear(
        lambda place: Sized(size=1.0, place=place, stands_out=stands_out(place, 1.0))
    )


def _first_clear(at: Callable[[int], Sized]) -> Sized:
    best = AS_MADE
    for place in range(PLACES):
        found = at(place)
        if found.stands_out > best.stands_out:
            best = found
        if found.stands_out >= WANTED:
            break
    return best


def _at(stands_out: StandsOut, place: int) -> Sized:
    """Search one place: the error above the floor grows about as the size does."""
    size, low, high, largest = 0.5, 0.0, np.inf, LARGEST
    best = Sized(size=LARGEST, place=place, stands_out=0.0)
    for _ in range(TRIALS):
        try:
            found = Sized(size=size, place=place, stands_out=stands_out(place, size))
        except (PlantError, ValidationError):  # no arm can have so much of it
            if size <= low:
                return best
            largest = 0.5 * (low + size)
            size = largest
            continue
        if found.stands_out >= WANTED:
            high, best = size, found
            if found.stands_out <= MOST:
                return best
        else:
            low = size
            if best.stands_out < WANTED and found.stands_out > best.stands_out:
                best = found
            if size >= largest:
                return best
        above = max(found.stands_out**2 - 1.0, 1e-6)
        size *= float(np.clip(np.sqrt((AIM**2 - 1.0) / above), 1.0 / 6.0, 4.0))
        if not low < size < high:
            size = np.sqrt(low * high) if low > 0.0 else 0.4 * high
        size = min(size, largest)
    return best
