"""Random numbers by cause: each name under a seed has a stream of its own.

What draws from one stream changes nothing in another, whichever causes there are, in whatever
order they draw, and however often.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from hashlib import sha256

import numpy as np

__all__ = ["Streams", "stream"]

Streams = Callable[..., np.random.Generator]
"""Streams under names already given, `partial(stream, seed, *names)`: called with the rest."""


def stream(seed: int, *names: str | int) -> np.random.Generator:
    """Begin the stream of a cause: the same seed and names give the same numbers everywhere.

    >>> one, again = stream(1, "hammer", 3), stream(1, "hammer", 3)
    >>> bool(one.random() == again.random())
    True
    """
    text = json.dumps([int(seed), *names])
    return np.random.default_rng(int.from_bytes(sha256(text.encode()).digest(), "big"))
