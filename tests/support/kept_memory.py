"""What a call leaves in memory, counted by Python's own allocator."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

__all__ = ["kept_bytes"]


def kept_bytes(action: Callable[[], object]) -> int:
    """Return the bytes that are held after the action and were not before it."""
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        action()
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    return after - before
