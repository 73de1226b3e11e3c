"""The sign of a hammer's force over a session: what most accepted hits have."""

from __future__ import annotations

import math
from collections.abc import Mapping

__all__ = ["HammerPolarity"]


class HammerPolarity:
    """Polarity of the accepted hits, by their number."""

    def __init__(self, before: Mapping[int, int] | None = None) -> None:
        self._of = dict(before or {})

    @property
    def known(self) -> int | None:
        """The sign of most accepted hits; None before the first."""
        total = sum(self._of.values())
        return None if total == 0 else int(math.copysign(1, total))

    def keep(self, number: int, polarity: int) -> bool:
        """Count an accepted hit; return whether it is news that the hammer is reversed."""
        news = polarity < 0 and self.known != polarity
        self._of[number] = polarity
        return news

    def drop(self, number: int) -> None:
        """Forget a hit that was taken back."""
        self._of.pop(number, None)
