"""Which blocks a board must cut out of known samples, `docs/board-protocol.md`, section 8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.board.records import Slope

__all__ = ["ExpectedBlocks", "expected_blocks"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedBlocks:
    """Trigger samples of the blocks that are held, and of those for which there was no buffer."""

    held: tuple[int, ...]
    missed: tuple[int, ...]


def crossings(values: npt.NDArray[np.int32], level: int, slope: Slope) -> npt.NDArray[np.intp]:
    """Return the indices i at which the level is crossed.

    >>> crossings(np.array([0, 5, 5, 2, 7], dtype=np.int32), 5, Slope.RISING)
    array([1, 4])
    >>> crossings(np.array([0, 5, 5, 2, 7], dtype=np.int32), 3, Slope.FALLING)
    array([3])
    """
    before, after = values[:-1], values[1:]
    if slope is Slope.RISING:
        return np.flatnonzero((before < level) & (after >= level)) + 1
    return np.flatnonzero((before > level) & (after <= level)) + 1


def expected_blocks(
    values: npt.NDArray[np.int32],
    *,
    level: int,
    slope: Slope,
    pretrigger: int,
    length: int,
    buffers: int | None = None,
) -> ExpectedBlocks:
    """Return the triggers among consecutive samples from index 0 on.

    Parameters
    ----------
    values : (n,) int32
        Counts of the trigger channel.
    buffers
        Blocks the board can hold, none being released; None for as many as wanted.

    >>> values = np.tile(np.array([0, 9], dtype=np.int32), 10)
    >>> expected_blocks(values, level=5, slope=Slope.RISING, pretrigger=2, length=6, buffers=1)
    ExpectedBlocks(held=(3,), missed=(7, 11, 15, 19))
    """
    held: list[int] = []
    missed: list[int] = []
    armed_from = pretrigger
    for trigger in crossings(values, level, slope).tolist():
        if trigger < armed_from:
            continue
        free = buffers is None or len(held) < buffers
        (held if free else missed).append(trigger)
        armed_from = trigger - pretrigger + length
    return ExpectedBlocks(held=tuple(held), missed=tuple(missed))
