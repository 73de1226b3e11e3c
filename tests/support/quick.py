"""Cases of a matrix: a few in the quick tests, all of them in the long ones."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def few_quick(cases: Iterable[Any], *quick: Any) -> list[Any]:
    """Return the cases as parameters; those that are not told are long."""
    every = list(cases)
    assert all(case in every for case in quick), quick
    return [one if one in quick else pytest.param(one, marks=pytest.mark.long) for one in every]


def every_but(cases: Iterable[Any], *long: Any) -> list[Any]:
    """Return the cases as parameters; those that are told are long."""
    every = list(cases)
    assert all(case in every for case in long), long
    return [pytest.param(one, marks=pytest.mark.long) if one in long else one for one in every]


def every_nth(cases: Collection[Any], n: int) -> list[Any]:
    """Return the cases as parameters; only one in `n` is quick, from the first on."""
    return [
        one if at % n == 0 else pytest.param(one, marks=pytest.mark.long)
        for at, one in enumerate(cases)
    ]
