"""How what a case hid compares with what a verdict tells, in the words and units of the latter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Compared", "TrueEffect", "told"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TrueEffect:
    """One effect of a case's truth, with what its comparison may need.

    place : joint, link, point or a list of them
    parameters : of any maker, its units in the names
    case : the truth of the whole case
    believed_n_m_per_rad : stiffness by joint, that sizes may be counted in
    found : how the effect of a verdict describes itself, where its size goes by that
    """

    place: Any
    parameters: Mapping[str, Any]
    case: Mapping[str, Any] = field(default_factory=dict)
    believed_n_m_per_rad: Mapping[str, float] = field(default_factory=dict)
    found: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """How effects of one name are compared; a module of this folder offers it in `COMPARED`.

    size : the true value of what the library's size parameter measures; KeyError where a maker
        tells another quantity
    beside : what a true arm has of the same kind anyway: nobody can tell it from what was hidden
    named : the name that a verdict should give it in its case, where that is another
    places : its places in the library's words, where those are others
    described : where and how it stands in an arm file's words, where no place tells; else None
    """

    size: Callable[[TrueEffect], float] | None = None
    beside: Callable[[TrueEffect], float] | None = None
    named: Callable[[TrueEffect], str | None] | None = None
    places: Callable[[TrueEffect], Sequence[str]] | None = None
    described: Callable[[TrueEffect], Mapping[str, object] | None] | None = None


def told(key: str) -> Compared:
    """Compare what a parameter tells as it is."""

    def size(true: TrueEffect) -> float:
        return float(true.parameters[key])

    return Compared(size=size)
