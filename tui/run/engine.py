"""The processes behind the screens: laboratory, watch, acquisition; started, heard and ended."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from daq.acquisition import run_acquisition
from daq.commands import Command, Stop
from daq.lab_watch import run_lab_watch
from daq.settings import AcquisitionSettings
from tui.run.happenings import Happening, ProcessGone

__all__ = ["Engine"]

Tell = Callable[[Happening], None]
END_TIMEOUT_S = 12.0


def _in_own_session(
    body: Callable[..., int], settings: AcquisitionSettings, channel: Connection[Any, Any]
) -> None:
    """Run a body out of reach of the terminal's hang-up, which would end it in mid-record."""
    os.setsid()
    body(settings, channel)


class Engine:
    """One process at a time that owns the devices, and the line to it.

    Parameters
    ----------
    tell
        Called on the event loop with every event.
    """

    def __init__(self, tell: Tell) -> None:
        # It wants the real standard error, which a running Textual app has put aside.
        resource_tracker.ensure_running()
        self._tell = tell
        self._process: BaseProcess | None = None
        self._channel: Connection[Any, Any] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ending = False

    @property
    def running(self) -> bool:
        """Whether a process is there to be told something."""
        return self._channel is not None

    def watch(self, settings: AcquisitionSettings) -> None:
        """Start watching the laboratory; nothing else may run."""
        self._start(run_lab_watch, settings, "armodal watch")

    def acquire(self, settings: AcquisitionSettings) -> None:
        """Start the acquisition; nothing else may run."""
        self._start(run_acquisition, settings, "armodal daq")

    def send(self, command: Command) -> None:
        """Tell the process something; one that has gone says so by itself."""
        if self._channel is not None:
            with suppress(OSError):
                self._channel.send(command)

    async def end(self, command: Stop) -> None:
        """Have the process end, and wait until its devices are free."""
        process = self._process
        if process is None:
            return
        self._ending = True
        self.send(command)
        # What it says last is heard while it is waited for.
        with suppress(TimeoutError):
            async with asyncio.timeout(END_TIMEOUT_S):
                while process.is_alive():
                    await asyncio.sleep(0.02)
        if process.is_alive():
            process.terminate()
        self._let_go()

    def abandon(self) -> None:
        """Hang up without waiting: the process finishes its journal by itself."""
        self._let_go(wait=False)

    def _start(self, body: Callable[..., int], settings: AcquisitionSettings, name: str) -> None:
        self._let_go()
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        # Not a daemon: what it has begun it also finishes when this program is killed.
        self._process = context.Process(
            target=_in_own_session, args=(body, settings, theirs), name=name
        )
        self._process.start()
        theirs.close()
        self._channel, self._ending = ours, False
        self._loop = asyncio.get_running_loop()
        self._loop.add_reader(ours.fileno(), self._hear)

    def _hear(self) -> None:
        channel = self._channel
        if channel is None:
            return
        try:
            while channel.poll(0):
                self._tell(channel.recv())
                if self._channel is not channel:
                    return
        except (EOFError, OSError):
            ended, self._ending = self._ending, True
            self._let_go(wait=False)
            if not ended:
                self._tell(ProcessGone())

    def _let_go(self, *, wait: bool = True) -> None:
        channel, self._channel = self._channel, None
        process, self._process = self._process, None
        if channel is not None:
            if self._loop is not None:
                self._loop.remove_reader(channel.fileno())
            channel.close()
        if process is not None and wait:
            process.join(END_TIMEOUT_S)
