"""Notes on postures as a person reads them: what holds of several is said once."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["noted_once"]

_OF_POSTURE = re.compile(r"posture '(?P<name>[^']*)': (?P<text>.*)", re.DOTALL)


def noted_once(notes: Iterable[str]) -> list[str]:
    """Return the notes in their order, with all postures named where they say the same.

    >>> noted_once(["posture 'a': noisy", "a hit was left out", "posture 'b': noisy"])
    ['postures a, b: noisy', 'a hit was left out']
    """
    postures: dict[str, list[str]] = {}
    for note in notes:
        found = _OF_POSTURE.fullmatch(note)
        names = postures.setdefault(note if found is None else found["text"], [])
        if found is not None:
            names.append(found["name"])
    return [
        f"posture{'s' if len(names) > 1 else ''} {', '.join(names)}: {text}" if names else text
        for text, names in postures.items()
    ]
