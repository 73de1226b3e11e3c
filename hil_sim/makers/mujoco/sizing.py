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

    Where no size does, the nearest that was tried. False position in logarithms, halved where it
    leaves the bracket.
    """
    wanted = STANDS_OUT[size_class]
    low, high = np.log(span[0]), np.log(span[1])
    tried: list[tuple[float, float]] = []
    at = 0.5 * (low + high)
    for _ in range(TRIALS):
        found = stands_out(float(np.exp(at)))
        tried.append((at, found))
        if wanted / NEAR <= found <= wanted * NEAR:
            break
        if found < wanted:
            low = at
        else:
            high = at
        if high - low < 0.02:
            break
        # Far below its class an effect grows in proportion to its size.
        guess = at + np.log(wanted / max(found, 1e-9))
        at = guess if low < guess < high else 0.5 * (low + high)
    best, found = min(tried, key=lambda pair: abs(np.log(max(pair[1], 1e-9) / wanted)))
    return float(np.exp(best)), found
