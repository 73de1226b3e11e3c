"""What is done when this process ends, by whatever signal: programs left behind would run on."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def at_the_end(command: str) -> Iterator[None]:
    """Run a shell's command at the end of the context, or of this process where that comes first.

    A shell of its own reads what nobody writes: its input ends with the last who could.
    """
    waiting = subprocess.Popen(
        ["sh", "-c", f"cat > /dev/null; {command}"], stdin=subprocess.PIPE, start_new_session=True
    )
    try:
        yield
    finally:
        waiting.communicate()
