"""How much reading a file may take: the bounds that all decoders of files share, in one place.

A file of 1 MB takes at most 200 MB of memory, one of 100 MB at most 1 GB and ten seconds of a
processor (`tests/protocols/test_bounds.py`). What a decoder will hold is worked out from headers
before it is made. Bounds of one format alone stand beside its decoder.
"""

from __future__ import annotations

__all__ = [
    "MOST_KEY_PARTS",
    "MOST_NUMBERS",
    "MOST_TABLE_DEPTH",
    "MOST_TEXT_NUMBERS",
    "most_decoded_bytes",
]

MOST_NUMBERS = 2**26  # of a file, or of what is compressed in it
MOST_TEXT_NUMBERS = 3 * 2**23  # of a table of text, where each is parsed: 3.5 to 6 million a second
MOST_TABLE_DEPTH = 32  # tables and arrays of TOML within one another
MOST_KEY_PARTS = 1000  # of TOML keys on one line, however they are quoted: n parts take n^2

_SMALL_BYTES = 32 * 2**20
_EXPANSION = 16  # 16-bit samples become 64-bit numbers, and compress four times at most
_LARGE_BYTES = 448 * 2**20


def most_decoded_bytes(file_bytes: int) -> int:
    """Return how many bytes of numbers and texts a file of so many bytes may become.

    What is measured compresses little: a file that becomes more was made to do harm.

    >>> most_decoded_bytes(1_000_000) // 10**6
    49
    """
    return min(_SMALL_BYTES + _EXPANSION * file_bytes, _LARGE_BYTES)
