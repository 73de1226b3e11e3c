"""A bound on what this process may take while a library reads a file.

A library that makes room for as much as a file says, before it looks whether the file has it,
cannot be asked beforehand. While the bound holds the system refuses it that room, and the library
reports an error like any other.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

try:
    import resource
except ImportError:  # not on every system
    resource = None  # type: ignore[assignment]

__all__ = ["address_space_bytes", "at_most_more", "nothing_bounded"]

_ONE_AT_A_TIME = threading.RLock()  # a limit put back by one thread would be another's bound


def address_space_bytes() -> int | None:
    """Return how much address space this process has; None where the system does not tell."""
    if resource is None:
        return None
    try:
        file = os.open("/proc/self/statm", os.O_RDONLY)
    except OSError:
        return None
    try:
        pages = int(os.read(file, 32).split()[0])
    finally:
        os.close(file)
    return pages * resource.getpagesize()


@contextmanager
def at_most_more(most_bytes: int) -> Iterator[None]:
    """Refuse this process more than so many bytes beyond what it has, until the end of the block.

    A request beyond them fails as where memory has run out. The bound is of the process, not of a
    thread: meanwhile other threads should do little, and start processes in `nothing_bounded` only.
    Linux only; elsewhere nothing is bounded.
    """
    with _ONE_AT_A_TIME:
        held = address_space_bytes()
        if held is None:
            yield
            return
        soft, hard = resource.getrlimit(resource.RLIMIT_AS)
        most = held + most_bytes
        lower = [limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY]
        with suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_AS, (min([most, *lower]), hard))
        try:
            yield
        finally:
            with suppress(ValueError, OSError):
                resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@contextmanager
def nothing_bounded() -> Iterator[None]:
    """Wait until no other thread bounds this process: a process started here has no such bound."""
    with _ONE_AT_A_TIME:
        yield
