"""Acquisition processes that start at once: forked from one that has imported all they need.

Each is a process of its own that runs the body of `armodal.daq.process`, and can be killed as that
can; what it saves is the seconds of imports.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from multiprocessing import forkserver
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from typing import Any

from armodal.daq.acquisition import run_acquisition
from armodal.daq.judge import prepare_judge
from armodal.daq.process import ask_for_priority
from armodal.daq.settings import AcquisitionSettings

TESTS = Path(__file__).resolve().parents[1]
_FORKS = multiprocessing.get_context("forkserver")
prepare_judge()  # in the process that is forked, too: it imports this module


@dataclass(frozen=True)
class ForkedAcquisition:
    """A running process, the line to it, and the file of its standard error."""

    process: ForkServerProcess
    channel: Connection[Any, Any]
    stderr: Path

    def last_word(self) -> str:
        """Return the last line of its standard error."""
        lines = self.stderr.read_text(errors="replace").strip().splitlines()
        return lines[-1] if lines else ""

    def end(self) -> None:
        """Kill it, if it has not ended, and let go of it."""
        self.process.kill()
        self.process.join()
        self.process.close()
        self.channel.close()


def fork_acquisition(settings: AcquisitionSettings, stderr: Path) -> ForkedAcquisition:
    """Start an acquisition in a process of its own."""
    _be_ready()
    ours, theirs = _FORKS.Pipe()
    arguments = (settings, theirs, dict(os.environ), stderr)
    process = _FORKS.Process(target=_run, args=arguments)
    process.start()
    theirs.close()
    return ForkedAcquisition(process=process, channel=ours, stderr=stderr)


@cache
def _be_ready() -> None:
    """Start the process that is forked; it finds the tests' modules by its environment alone."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(TESTS), *([before] if before else [])])
    try:
        _FORKS.set_forkserver_preload([__name__])
        forkserver.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


def _run(
    settings: AcquisitionSettings,
    channel: Connection[Any, Any],
    environment: Mapping[str, str],
    stderr: Path,
) -> None:
    """The body, with what a program started now would be given."""
    os.environ.update(environment)
    sys.path[:0] = [path for path in environment.get("PYTHONPATH", "").split(os.pathsep) if path]
    written = os.open(stderr, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    os.dup2(written, 2)
    os.setsid()
    ask_for_priority()
    sys.exit(run_acquisition(settings, channel))
