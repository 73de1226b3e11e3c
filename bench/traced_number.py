"""A number that tells whether a change of it could have changed anything.

It stands in the place of a constant and takes its changed values along, through whatever is
computed of it. Where a comparison would come out otherwise, or the number goes where it cannot be
followed (a count of steps, a slice, a library that wants a plain one), the change is noted. A run
that notes nothing of a change would have run alike with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

__all__ = ["TracedNumber"]


class TracedNumber(NDArrayOperatorsMixin):
    """A value as it is, and as it would be after each of some changes.

    `noted` gets the names of changes that could matter; numbers of one run share it.
    """

    def __init__(self, plain: Any, changed: Mapping[str, Any], noted: set[str]) -> None:
        self.plain, self.changed, self.noted = plain, dict(changed), noted

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        """Compute with all values at once; what compares is told as it is."""
        of_them = [own for own in inputs if isinstance(own, TracedNumber)]
        if method != "__call__" or kwargs:
            return getattr(ufunc, method)(*(_let_go(own) for own in inputs), **kwargs)
        plain = ufunc(*(own.plain if isinstance(own, TracedNumber) else own for own in inputs))
        changed = {}
        for name in dict.fromkeys(name for own in of_them for name in own.changed):
            other = ufunc(
                *(
                    own.changed.get(name, own.plain) if isinstance(own, TracedNumber) else own
                    for own in inputs
                )
            )
            if plain.dtype != bool:
                changed[name] = other
            elif np.any(other != plain):
                self.noted.add(name)
        return plain if plain.dtype == bool else TracedNumber(plain, changed, self.noted)

    def let_go(self) -> Any:
        """Return it as it is, where nobody follows it."""
        self.noted.update(self.changed)
        return self.plain

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        """As an array of its own."""
        return np.array(self.let_go(), dtype=dtype, copy=copy)

    def __float__(self) -> float:
        """As a plain number."""
        return float(self.let_go())

    def __int__(self) -> int:
        """As a plain whole number."""
        return int(self.let_go())

    def __index__(self) -> int:
        """As a count, or an end of a slice."""
        return int(self.let_go())

    def __bool__(self) -> bool:
        """Whether it is not zero."""
        return bool(self.let_go())

    def __getitem__(self, key: Any) -> Any:
        """Return a part of an array that was computed with it."""
        return self.let_go()[key]

    def __hash__(self) -> int:
        """As a key."""
        return hash(self.let_go())

    def __format__(self, how: str) -> str:
        """In words, which say nothing of what was decided."""
        return format(self.plain, how)

    def __getattr__(self, name: str) -> Any:
        """What an array or a plain number has besides."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.let_go(), name)


def _let_go(value: Any) -> Any:
    return value.let_go() if isinstance(value, TracedNumber) else value
