"""Named arrays as a file of another program holds them, before anybody says what they mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.printable import printable

__all__ = ["Axis", "Listed", "Variable", "Variables", "listing", "one_line"]

_MOST_LISTED = 24
_LONGEST = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Listed:
    """One thing in a file, as `armodal inspect` and refusals name it."""

    name: str
    shape: tuple[int, ...]
    type: str
    unit: str = ""
    role: str = ""

    @property
    def words(self) -> str:
        """Return name, size, type and unit: `Hf (1601 x 1 complex)`."""
        size = " x ".join(map(str, self.shape))
        unit = f", {self.unit[:20]}" if self.unit else ""
        return one_line(f"{self.name[:40]} ({f'{size} {self.type}'.strip()}{unit})")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Variable:
    """An array of numbers under the file's own name and in its own unit."""

    name: str
    values: npt.NDArray[Any]  # float64 or complex128
    unit: str = ""

    @property
    def is_complex(self) -> bool:
        """Whether the numbers are complex."""
        return bool(np.iscomplexobj(self.values))


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """An even axis told by its first value and its step, in s or Hz.

    `rounding` is relative: 0.000977 s stands for anything from 0.0009765 to 0.0009775 s.
    """

    unit: str
    first: float
    step: float
    rounding: float = 1e-7


@dataclass(frozen=True, slots=True, kw_only=True)
class Variables:
    """What belongs together in a file: all of it, or one of its sections."""

    origin: str
    format: str  # in words: "text table", "MATLAB 5"
    variables: tuple[Variable, ...]
    named: bool = True  # False where names are places: "column 1"
    is_table: bool = False  # whether the order of the variables is that of columns
    axis: Axis | None = None
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    words: str = ""  # of a header
    others: tuple[Listed, ...] = ()  # what is there and is not read
    said: tuple[str, ...] = ()

    @property
    def listed(self) -> tuple[Listed, ...]:
        """Return everything in it."""
        arrays = tuple(
            Listed(
                name=v.name,
                shape=v.values.shape,
                type="complex" if v.is_complex else "real",
                unit=v.unit,
            )
            for v in self.variables
        )
        texts = tuple(
            Listed(name=name, shape=(len(words),), type="text")
            for name, words in self.texts.items()
        )
        return (*arrays, *texts, *self.others)


def one_line(text: str) -> str:
    r"""Return text that may hold a file's own bytes as a message may show it.

    >>> print(one_line("a\nb"))
    a\nb
    """
    return printable(text[:_LONGEST], keep="")


def listing(listed: Sequence[Listed]) -> str:
    """Return what was found in one clause, for the end of a refusal.

    >>> listing([Listed(name="H", shape=(9, 2), type="complex")])
    'found H (9 x 2 complex)'
    """
    if not listed:
        return "found nothing in it"
    words = [one.words for one in listed[:_MOST_LISTED]]
    more = len(listed) - len(words)
    return "found " + ", ".join(words) + (f" and {more} more" if more else "")
