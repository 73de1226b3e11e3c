"""Whether numbers rise evenly, as the axis of a table does."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["is_counter", "is_even", "never_falls"]

_EVEN = 0.5  # of a step: a column printed with few digits jumps, but does not drift


def is_counter(values: npt.NDArray[Any]) -> bool:
    """Return whether numbers count up from 0 or 1.

    >>> is_counter(np.array([1.0, 2.0, 3.0]))
    True
    """
    first = values[0]
    return first in {0, 1} and bool(np.array_equal(values, first + np.arange(len(values))))


def never_falls(values: npt.NDArray[Any]) -> bool:
    """Return whether numbers rise without ever falling, as an axis printed with few digits does.

    >>> never_falls(np.array([0.0, 0.998, 0.999, 0.999, 1.0]))
    True
    """
    numbers = np.asarray(np.real(values), dtype=np.float64)
    return bool(np.all(np.diff(numbers) >= 0.0) and numbers[-1] > numbers[0])


def is_even(values: npt.NDArray[Any]) -> bool:
    """Return whether three numbers or more rise in equal steps, as far as they are printed.

    >>> is_even(np.array([0.0, 0.33, 0.67, 1.0]))
    True
    """
    numbers = np.asarray(np.real(values), dtype=np.float64)
    if numbers.ndim != 1 or len(numbers) < 3 or not np.isfinite(numbers).all():
        return False
    mean = float(numbers[-1] - numbers[0]) / (len(numbers) - 1)
    if mean <= 0.0 or (np.diff(numbers) <= 0.0).any():
        return False
    off = numbers - numbers[0] - mean * np.arange(len(numbers))
    return bool(np.max(np.abs(off)) <= _EVEN * mean)
