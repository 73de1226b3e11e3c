"""Lines of JSON that outlive the study that writes them: each is on the disk once it is judged."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor, Future, as_completed
from pathlib import Path
from typing import Any

from armodal.protocols.errors import SessionError

__all__ = ["Line", "kept_lines", "run_and_keep"]

Line = dict[str, Any]


def kept_lines(path: Path, *keys: str, tell: Callable[[str], None] = lambda _: None) -> list[Line]:
    """Return the lines of a study's file, and leave the file so that it can be gone on with.

    A last line that was torn is taken out of the file, and told.

    Parameters
    ----------
    keys
        What every line must have.

    Raises
    ------
    SessionError
        If another line than the last is not one of a study.
    """
    if not path.exists():
        return []
    content = path.read_bytes()
    rows = content.rstrip().split(b"\n") if content.strip() else []
    lines, whole = [], 0
    for number, row in enumerate(rows, start=1):
        line = _line_of(row, keys)
        if line is not None:
            lines.append(line)
            whole += len(row) + 1
        elif number < len(rows):
            raise SessionError(
                f"{path}: line {number}: wanted an object with {', '.join(keys)}, got something "
                "else; take the line out, or move the file away"
            )
        else:
            tell(f"{path}: line {number} is torn: it is dropped, and judged again")
    kept = content[:whole]
    with path.open("r+b") as file:
        file.truncate(len(kept))
        if kept and not kept.endswith(b"\n"):
            file.seek(len(kept))
            file.write(b"\n")
    return lines


def _line_of(row: bytes, keys: Sequence[str]) -> Line | None:
    try:
        line = json.loads(row.decode())
    except (ValueError, RecursionError):
        return None
    if not isinstance(line, dict) or not all(isinstance(line.get(k), int | str) for k in keys):
        return None
    return line


def run_and_keep(
    path: Path,
    executor: Executor,
    judge: Callable[..., Line],
    jobs: Iterable[tuple[Any, ...]],
    tell: Callable[[Line], None],
) -> None:
    """Judge jobs in parallel; each line goes to the end of the file as soon as it is there.

    Where this ends early, stopped or by a job that fails, jobs that wait are cancelled and those
    that are finished are kept.

    Parameters
    ----------
    judge
        Called with a job's values, in a worker.
    tell
        Called with each line, as it reads in the file, after it is on the disk.
    """
    with path.open("a", encoding="utf-8") as file:
        futures = [executor.submit(judge, *job) for job in jobs]
        kept = set()

        def keep(future: Future[Line]) -> None:
            kept.add(future)
            text = json.dumps(future.result())
            file.write(text + "\n")
            file.flush()
            os.fsync(file.fileno())
            tell(json.loads(text))

        try:
            for future in as_completed(futures):
                keep(future)
        except BaseException:
            for future in futures:  # of a study that ends early nobody wants the rest
                future.cancel()
            for future in futures:
                is_done = future.done() and not future.cancelled()
                if is_done and future not in kept and future.exception() is None:
                    keep(future)
            raise
