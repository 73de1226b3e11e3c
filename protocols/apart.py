"""Programs of others at work on a file, in a process of its own that takes so much and no more.

What expands or compiles a file for us may be told by it to repeat something without end. Its memory
and time are bounded by the system, and a crash of it is a refusal like any other.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from importlib import import_module

from armodal.protocols.errors import (
    ArmError,
    ArmodalError,
    ForeignFileError,
    MissingPackageError,
)
from armodal.protocols.memory_bound import address_space_bytes

__all__ = ["apart", "bytes_allowed", "most_bytes_beside", "most_s_beside"]

_MOST_S = 8  # of a processor; with what we do of the result, within ten
_BYTES_PER_S = 2_000_000  # of messages and nodes that are decoded one by one
_BUSY = 15  # times slower than its processor, on a machine with much else to do
_SMALL_FILE = 1_100_000
# With what our own process takes of the result, within the bounds of `protocols.bounds`.
_SMALL_BYTES, _LARGE_BYTES = 150_000_000, 800_000_000
_MOST_TEXT = 32 * 2**20
_RAISED = {error.__name__: error for error in (ArmError, ForeignFileError, MissingPackageError)}


def bytes_allowed(text: str) -> int:
    """Return how much memory may be taken over a file's text: much where it names other files."""
    alone = "file" not in text and "load_yaml" not in text
    return most_bytes_beside(len(text)) if alone else _LARGE_BYTES


def most_bytes_beside(size: int) -> int:
    """Return how much memory may be taken over a file of so many bytes that names no others."""
    return _SMALL_BYTES if size <= _SMALL_FILE else _LARGE_BYTES


def most_s_beside(size: int) -> int:
    """Return how many seconds of a processor may be taken over a file of so many bytes."""
    return _MOST_S + size // _BYTES_PER_S


def apart(
    function: str,
    arguments: Mapping[str, object],
    *,
    most_bytes: int,
    what: str,
    most_s: int = _MOST_S,
    error: type[ArmodalError] = ArmError,
) -> str:
    """Call a function of ours in another process, and return the text that it returns.

    Parameters
    ----------
    function
        `module:name`; its arguments are named, and such as JSON holds.
    most_bytes
        Memory that it may take beyond its libraries.
    what
        The file, for the message of a refusal.
    most_s
        Seconds of a processor.
    error
        What is raised where it took more than it may, or crashed.

    Raises
    ------
    ArmodalError
        As the function raises it, or `error`.
    """
    order = json.dumps(
        {
            "function": function,
            "arguments": arguments,
            "most_bytes": most_bytes,
            "most_s": most_s,
        }
    )
    refusal = error(
        f"{what}: wanted a file that is read within {most_s} s of a processor and "
        f"{most_bytes // 1_000_000} MB, it takes more; does it repeat something very often?"
    )
    try:
        # Our own module, and a file's name as data.
        done = subprocess.run(  # noqa: S603
            [sys.executable, "-m", __name__],
            input=order.encode(), capture_output=True, check=False, timeout=_BUSY * most_s,
        )  # fmt: skip
    except subprocess.TimeoutExpired as late:
        raise refusal from late
    try:
        kind, text = json.loads(done.stdout)
    except ValueError as cut:
        raise refusal from cut
    if kind == "returned":
        return str(text)
    raise _RAISED.get(kind, ArmError)(str(text))


def _bound(most_bytes: int, most_s: int) -> None:
    """Bound this process from here on, as far as the system does that."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return
    held, used_s = address_space_bytes(), int(time.process_time())
    for kind, most in (
        (resource.RLIMIT_AS, held + most_bytes if held else resource.RLIM_INFINITY),
        (resource.RLIMIT_CPU, used_s + most_s),
    ):
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (most, most))


def _main() -> None:
    order = json.load(sys.stdin)
    module, _, name = order["function"].partition(":")
    function = getattr(import_module(module), name)
    told = sys.stdout
    sys.stdout = sys.stderr  # what a library says is not the answer
    prepare = getattr(import_module(module), "prepare", None)
    if prepare is not None:
        with suppress(ArmodalError):
            prepare()
    _bound(order["most_bytes"], order["most_s"])
    try:
        answer = ["returned", function(**order["arguments"])]
        if len(answer[1]) > _MOST_TEXT:
            answer = ["ArmError", f"wanted a text of at most {_MOST_TEXT} bytes, it becomes longer"]
    except ArmodalError as error:
        answer = [type(error).__name__, str(error)]
    json.dump(answer, told)


if __name__ == "__main__":
    _main()
