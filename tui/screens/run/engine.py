"""The processes behind the screens: watch and acquisition; started, heard and ended."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress

from armodal.daq.commands import Command, Stop
from armodal.daq.process import DaqProcess, start_process
from armodal.daq.settings import AcquisitionSettings
from armodal.tui.screens.run.happenings import Happening, ProcessGone

__all__ = ["Engine"]

Tell = Callable[[Happening], None]
END_TIMEOUT_S = 12.0


class Engine:
    """One process at a time that owns the devices, and the line to it.

    Parameters
    ----------
    tell
        Called on the event loop with every event.
    """

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._running: DaqProcess | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ending = False

    def watch(self, settings: AcquisitionSettings) -> None:
        """Start watching the laboratory; what ran before is let go."""
        self._start("watch", settings)

    def acquire(self, settings: AcquisitionSettings) -> None:
        """Start the acquisition; what ran before is let go."""
        self._start("acquire", settings)

    def hear(self) -> None:
        """Take in at once what the process has said and nobody has listened to yet."""
        self._hear()

    def send(self, command: Command) -> None:
        """Tell the process something; one that has gone says so by itself."""
        if self._running is not None:
            with suppress(OSError):
                self._running.channel.send(command)

    async def end(self, command: Stop) -> None:
        """Have the process end, and wait until its devices are free."""
        running = self._running
        if running is None:
            return
        self._ending = True
        self.send(command)
        # What it says last is heard while it is waited for.
        with suppress(TimeoutError):
            async with asyncio.timeout(END_TIMEOUT_S):
                while running.alive:
                    await asyncio.sleep(0.02)
        if running.alive:
            running.process.terminate()
        self.abandon()

    def abandon(self) -> None:
        """Hang up without waiting: the process finishes its journal by itself."""
        running, self._running = self._running, None
        if running is None:
            return
        if self._loop is not None:
            self._loop.remove_reader(running.channel.fileno())
        running.channel.close()
        running.stderr.close()

    def _start(self, body: str, settings: AcquisitionSettings) -> None:
        self.abandon()
        self._running, self._ending = start_process(body, settings), False
        self._loop = asyncio.get_running_loop()
        self._loop.add_reader(self._running.channel.fileno(), self._hear)

    def _hear(self) -> None:
        running = self._running
        if running is None:
            return
        try:
            while running.channel.poll(0):
                self._tell(running.channel.recv())
                if self._running is not running:
                    return
        except (EOFError, OSError):
            ended, self._ending = self._ending, True
            last_word = running.last_word()
            self.abandon()
            if not ended:
                self._tell(ProcessGone(last_word=last_word))
