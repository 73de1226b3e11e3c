"""A command of armodal run beside the app, in a process of its own that can be stopped."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from armodal.protocols.errors import EstimateError
from armodal.protocols.memory_bound import nothing_bounded

__all__ = ["ARMODAL", "CommandRun"]

ARMODAL = (sys.executable, "-m", "armodal.tui.cli")
_LINE_LIMIT = 64 * 1024 * 1024  # one JSON object may be one line


@dataclass(slots=True)
class CommandRun:
    """Runs `armodal ... --json`: progress lines as they come, one object at the end.

    Parameters
    ----------
    arguments
        What follows `armodal`.
    progress
        Called with each line of progress.
    command
        How armodal is started.
    """

    arguments: tuple[str, ...]
    progress: Callable[[str], None]
    command: tuple[str, ...] = ARMODAL
    _process: asyncio.subprocess.Process | None = None
    _stopped: bool = False

    async def result(self) -> dict[str, Any]:
        """Run to the end.

        Raises
        ------
        EstimateError
            If the command fails, says something else than one object, or was stopped.
        """
        with nothing_bounded():
            self._process = await asyncio.create_subprocess_exec(
                *self.command,
                *self.arguments,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                limit=_LINE_LIMIT,
            )
        process = self._process
        last: list[str] = []
        try:
            output, _ = await asyncio.gather(_read_all(process), self._listen(process, last))
            code = await process.wait()
        finally:
            self.stop()
        name = f"armodal {self.arguments[0]}"
        if self._stopped and code != 0:
            raise EstimateError(f"{name}: stopped; start it again when wanted")
        if code != 0:
            said = " ".join(last[-3:]) or f"exit code {code}"
            raise EstimateError(f"{name} did not finish: {said}")
        try:
            value = json.loads(output)
        except ValueError:
            value = None
        if not isinstance(value, dict):
            raise EstimateError(f"{name}: wanted one JSON object, got {output[:60]!r}")
        return value

    async def _listen(self, process: asyncio.subprocess.Process, last: list[str]) -> None:
        if process.stderr is None:
            return
        async for raw in process.stderr:
            line = raw.decode("utf-8", "replace").strip()
            if line:
                last.append(line)
                self.progress(line.removeprefix("· "))

    def stop(self) -> None:
        """End the command, if it runs."""
        if self._process is not None and self._process.returncode is None:
            self._stopped = True
            self._process.terminate()


async def _read_all(process: asyncio.subprocess.Process) -> bytes:
    return b"" if process.stdout is None else await process.stdout.read()
