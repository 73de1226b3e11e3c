"""How fast a processor is just now: without that the time of a case says little.

A core whose parts are shared with a neighbour, in a machine that others share, takes up to twice
as long for the same.
"""

from __future__ import annotations

from time import process_time

__all__ = ["REFERENCE_S", "pace"]

REFERENCE_S = 0.062  # the study's machine undisturbed, CPython 3.11
_SQUARES, _TIMES = 1_000_000, 3


def pace() -> float:
    """Return times of the reference's that a million squares, summed, take here and now."""
    begin = process_time()
    for _ in range(_TIMES):
        _sum_squares()
    return (process_time() - begin) / (_TIMES * REFERENCE_S)


def _sum_squares() -> int:
    total = 0
    for i in range(_SQUARES):
        total += i * i
    return total
