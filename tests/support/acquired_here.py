"""Acquisitions of commands in the tests' own process, where another one is not the point."""

from __future__ import annotations

import multiprocessing
import threading
from dataclasses import dataclass, field
from io import BytesIO
from multiprocessing.connection import Connection
from typing import Any

from armodal.daq.acquisition import run_acquisition
from armodal.daq.settings import AcquisitionSettings


@dataclass(frozen=True)
class AcquiredHere:
    """A thread in place of an `armodal.daq.process.DaqProcess`."""

    thread: threading.Thread
    channel: Connection[Any, Any]
    stderr: BytesIO = field(default_factory=BytesIO)

    @property
    def process(self) -> AcquiredHere:
        return self

    def wait(self, timeout_s: float | None = None) -> None:
        self.thread.join(timeout_s)
        assert not self.thread.is_alive()

    def last_word(self) -> str:
        return ""


def start_here(body: str, settings: AcquisitionSettings) -> AcquiredHere:
    """Start an acquisition in a thread."""
    assert body == "acquire"
    ours, theirs = multiprocessing.Pipe()

    def run() -> None:
        with theirs:
            run_acquisition(settings, theirs)

    thread = threading.Thread(target=run)
    thread.start()
    return AcquiredHere(thread=thread, channel=ours)
