"""Where two records differ, arrays and NaN included."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np

__all__ = ["first_difference"]


def first_difference(one: object, other: object, path: str) -> str | None:
    """Return the path of the first field in which two records differ, or None.

    Arrays are equal if shape, type and every element are; NaN equals NaN.

    >>> first_difference((1, 2.0), (1, 3.0), "pair")
    'pair[1]'
    """
    if type(one) is not type(other):
        return path
    parts = _parts(one, other, path)
    if parts is None:
        return None if _equal_leaves(one, other) else path
    for a, b, part_path in parts:
        difference = first_difference(a, b, part_path)
        if difference is not None:
            return difference
    return None


def _parts(one: object, other: object, path: str) -> list[tuple[object, object, str]] | None:
    """Pair the parts of two records of the same type; None if they are leaves."""
    if is_dataclass(one):
        names = [field.name for field in fields(one)]
        return [(getattr(one, name), getattr(other, name), f"{path}.{name}") for name in names]
    if isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
        return [(a, b, f"{path}[{i}]") for i, (a, b) in enumerate(zip(one, other, strict=True))]
    if isinstance(one, Mapping) and isinstance(other, Mapping) and one.keys() == other.keys():
        return [(one[key], other[key], f"{path}[{key!r}]") for key in one]
    return None


def _equal_leaves(one: object, other: object) -> bool:
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        equal_nan = one.dtype.kind in "fc"
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=equal_nan)
    if isinstance(one, float) and isinstance(other, float):
        return one == other or (math.isnan(one) and math.isnan(other))
    return one == other
