"""Sizes of effects by how far they stand out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["STANDS_OUT", "size_to_stand_out"]

# By class: root mean square of the change that nothing ordinary imitates, in parts of what
# repeating a session changes. Each may be met to a tenth of a factor either way.
STANDS_OUT = {"faint": 1.3, "medium": 3.0, "clear": 7.0}
NEAR = 1.12
TRIALS = 9


def size_to_stand_out(
    stands_out: Callable[[float], float], span: tuple[float, float], size_class: str
) -> tuple[float, float]:
    """Return the size in a span that stands out as its class wants, and how far it does.

    Where no size does, the nearest that was tried. False position in logarithms (Illinois variant:
    an end that stays counts half), from a middle of the span outwards.
    """
    wanted = STANDS_OUT[size_class]
    ends = [np.log(span[0]), np.log(span[1])]
    misses: list[float | None] = [None, None]  # ln of found over wanted, at the ends tried
    tried: list[tuple[float, float]] = []
    at = 0.5 * (ends[0] + ends[1])
    for _ in range(TRIALS):
        found = stands_out(float(np.exp(at)))
        miss = float(np.log(max(found, 1e-9) / wanted))
        tried.append((at, miss))
        if abs(miss) <= np.log(NEAR) or ends[1] - ends[0] < 1e-3:
            break
        side = int(miss > 0.0)
        other = misses[1 - side]
        if other is not None and misses[side] is not None:
            misses[1 - side] = 0.5 * other
        ends[side], misses[side] = at, miss
        low, high = misses
        if low is not None and high is not None:
            at = ends[0] + (ends[1] - ends[0]) * low / (low - high)
        else:  # an effect far below its class grows in proportion to its size
            at = float(np.clip(at - 1.2 * miss, ends[0], ends[1]))
    best, miss = min(tried, key=lambda pair: abs(pair[1]))
    return float(np.exp(best)), float(wanted * np.exp(miss))
