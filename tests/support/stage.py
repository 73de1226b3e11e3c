"""The app on a stage: events are told to it, and what it says to the acquisition is noted."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from unittest.mock import Mock, patch

from support.made_run import ARM, PLAN
from support.screen import Notices
from support.shipped_screens import SHIPPED_SCREENS
from textual.pilot import Pilot

from armodal.daq.commands import Command
from armodal.daq.settings import AcquisitionSettings
from armodal.tui.screens.run import app
from armodal.tui.screens.run.collector import CalmCollector
from armodal.tui.screens.run.engine import Engine
from armodal.tui.screens.run.happenings import Happening, Tick
from armodal.tui.screens.run.options import RunOptions
from armodal.tui.screens.run.place import SessionPlace
from armodal.tui.screens.run.step_screen import Pane

NOW_S = 100.0


class StageEngine(Engine):
    """A process of which there is only what it was told, and what it has to say."""

    def __init__(self, tell: Callable[[Happening], None], stage: Stage) -> None:
        super().__init__(tell)
        self._tell_app, self._stage = tell, stage

    def send(self, command: Command) -> None:
        self._stage.sent.append(command)

    def watch(self, settings: AcquisitionSettings) -> None:
        """There is no process that could watch."""

    def hear(self) -> None:
        while self._stage.unheard:
            self._tell_app(self._stage.unheard.pop(0))


class Stage:
    """An app whose process is a list of what it was told; further screens are those of a test.

    Its garbage is left to Python: the tests hold ten times the objects of an app.
    """

    def __init__(self, tmp_path: Path, plan=PLAN, screens=None, **options) -> None:
        place = SessionPlace(journal=tmp_path / "s.journal", arm=ARM, plan=plan, begun=False)
        self.now_s = NOW_S
        self.sent: list[Command] = []
        self.unheard: list[Happening] = []  # said, and not listened to yet
        self.notices = Notices()
        self.collector = Mock(spec=CalmCollector)
        with patch.object(app, "CalmCollector", lambda: self.collector):
            self.app = app.RunApp(
                RunOptions(place=place, **options),
                clock=lambda: self.now_s,
                make_engine=lambda tell: StageEngine(tell, self),
                screens={**SHIPPED_SCREENS, **(screens or {})},
            )

    async def tell(self, pilot: Pilot[int], *events: Happening) -> None:
        for event in events:
            self.app.conductor.tell(event)
        await self.settle(pilot)

    async def settle(self, pilot: Pilot[int]) -> None:
        self.app.redraw()
        await pilot.pause()
        self.app.conductor.tell(Tick(now_s=self.now_s))  # after which everything is drawn again
        self.app.redraw()
        await pilot.pause()

    def text(self) -> str:
        panes = [pane for pane in self.app.screen.query(Pane) if pane.display]
        return "\n".join(pane.plain for pane in panes)


def play(
    stage: Stage, body: Callable[[Pilot[int]], Awaitable[None]], size: tuple[int, int] = (120, 36)
) -> None:
    """Play a part on the stage; the app looks by itself once a second: the part says when to."""

    async def run() -> None:
        async with stage.app.run_test(size=size, message_hook=stage.notices) as pilot:
            await body(pilot)

    with patch.object(app, "REDRAW_WALL_S", 1.0):
        asyncio.run(run())
