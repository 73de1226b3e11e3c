"""Names made as short as a column, told apart still."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["short_names"]


def short_names(names: Sequence[str], width: int) -> tuple[str, ...]:
    """Return different names in at most `width` characters each, as whole as they can be.

    Words that all end with go first, then words that all begin with, then the middle; where names
    are alike even so, their number stands in front.

    >>> short_names(("shoulder_pan_joint", "shoulder_lift_joint"), 13)
    ('shoulder_pan', 'shoulder_lift')
    >>> short_names(("axis", "axis_of_the_flange_b"), 9)
    ('axis', 'axis…ge_b')
    >>> short_names(("longitudinal", "longiradinal"), 5)
    ('1…nal', '2…nal')
    """
    for shorten in (tuple, _without_common_end, _without_common_beginning):
        names = shorten(names) if len(names) > 1 else tuple(names)
        if max(map(len, names), default=0) <= width:
            return names
    short = tuple(_middle_cut(name, width) for name in names)
    if len(set(short)) == len(set(names)):
        return short
    return tuple(
        _tail(f"{number}", name, width) if len(name) > width else name
        for number, name in enumerate(names, 1)
    )


def _without_common_end(names: Sequence[str]) -> tuple[str, ...]:
    """Leave out words, parted by `_`, that all names end with."""
    parts = [name.split("_") for name in names]
    end = _in_common([part[::-1] for part in parts])
    return tuple("_".join(part[: len(part) - end]) for part in parts)


def _without_common_beginning(names: Sequence[str]) -> tuple[str, ...]:
    """Leave out words, parted by `_`, that all names begin with."""
    parts = [name.split("_") for name in names]
    begin = _in_common(parts)
    return tuple("_".join(part[begin:]) for part in parts)


def _in_common(parts: Sequence[Sequence[str]]) -> int:
    """How many words all begin with; one of each is kept."""
    most = min(map(len, parts)) - 1
    return next((i for i in range(most) if len({part[i] for part in parts}) > 1), max(most, 0))


def _middle_cut(name: str, width: int) -> str:
    if len(name) <= width:
        return name
    behind = (width - 1) // 2
    return f"{name[: width - 1 - behind]}…{name[len(name) - behind :]}"


def _tail(number: str, name: str, width: int) -> str:
    kept = max(width - len(number) - 1, 0)
    return f"{number}…{name[len(name) - kept :]}"[:width]
