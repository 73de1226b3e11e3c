"""The acquisition as a program: `python -m armodal.daq.process BODY DESCRIPTOR`.

It imports what it needs and no more, so it is ready sooner than a process that has to import the
program that started it, and it has a session of its own, out of reach of a terminal's hang-up.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import IO, Any

from armodal.daq.acquisition import run_acquisition
from armodal.daq.lab_watch import run_lab_watch
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.memory_bound import nothing_bounded

__all__ = ["DaqProcess", "ask_for_priority", "start_process"]

BODIES = {"acquire": run_acquisition, "watch": run_lab_watch}
LONGEST_LAST_WORD = 4096  # bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class DaqProcess:
    """A running process with the line to it."""

    process: subprocess.Popen[bytes]
    channel: Connection[Any, Any]
    stderr: IO[bytes]

    @property
    def alive(self) -> bool:
        """Whether it runs."""
        return self.process.poll() is None

    def last_word(self) -> str:
        """Return the last line of its standard error: what a crash said."""
        size = self.stderr.seek(0, 2)
        self.stderr.seek(max(size - LONGEST_LAST_WORD, 0))
        lines = self.stderr.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else ""


def start_process(body: str, settings: AcquisitionSettings) -> DaqProcess:
    """Start a body in a process of its own, and hand it its settings.

    Parameters
    ----------
    body
        A name of `BODIES`.
    """
    ours, theirs = socket.socketpair()
    stderr = tempfile.TemporaryFile()  # noqa: SIM115 - it is read when the process has gone
    with theirs, nothing_bounded():
        command = [sys.executable, "-m", "armodal.daq.process", body, str(theirs.fileno())]
        # The command is composed here, of this interpreter and checked values.
        process = subprocess.Popen(  # noqa: S603
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
            pass_fds=[theirs.fileno()],
            start_new_session=True,
        )
    channel: Connection[Any, Any] = Connection(ours.detach())
    channel.send(settings)
    return DaqProcess(process=process, channel=channel, stderr=stderr)


def ask_for_priority() -> None:
    """Ask to be run before ordinary work, which need not be granted: all goes on without, too.

    A port's buffer holds some tenths of a second, and on a machine with more work than cores a
    process can wait longer for its turn than that.
    """
    if sys.platform == "linux":
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))


def main(arguments: list[str]) -> int:
    """Take the settings from the line, and run the body."""
    body, descriptor = arguments
    ask_for_priority()
    channel: Connection[Any, Any] = Connection(int(descriptor))
    return BODIES[body](channel.recv(), channel)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
