"""Tests in parts: all of them are too long for one run, a part of them is not."""

from __future__ import annotations

import zlib


def in_share(name: str, share: str) -> bool:
    """Whether a test is of part K of N, `share` K/N from 0/N: by its name, the same everywhere."""
    part, of = (int(number) for number in share.split("/"))
    return zlib.crc32(name.encode()) % of == part
