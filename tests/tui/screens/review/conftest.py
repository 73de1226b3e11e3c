import asyncio
from dataclasses import dataclass, replace

import pytest
from support.once_for_all import once_for_all
from support.screen import Notices
from support.shipped_screens import SHIPPED_PANES

from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.review.command_run import ARMODAL
from armodal.tui.screens.review.panes import shape
from armodal.tui.screens.review.posture_view import fit_automatic, opened_session


@pytest.fixture(scope="session")
def opened(session, tmp_path_factory):
    """Every posture fitted once for all tests."""

    def fitted():
        read = opened_session(tmp_path_factory.mktemp("opened") / "s.h5", session)
        views = tuple(fit_automatic(read.superset, view) for view in read.views)
        return replace(read, views=views)

    return once_for_all(tmp_path_factory, "opened", fitted)


@dataclass
class Clock:
    now: float = 0.0

    def __call__(self):
        return self.now


@pytest.fixture(autouse=True)
def _unhurried_pictures(monkeypatch):
    """Shapes move by themselves once a second: a screen that never rests is waited for in vain."""
    monkeypatch.setattr(shape, "FRAMES_A_SECOND", 1)


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def notices():
    """What the app has told in notices, one text each."""
    return Notices()


@pytest.fixture
def drive(opened, tmp_path, clock, notices):
    """Runs a coroutine function of (app, pilot) on the app with every posture fitted."""

    def run(
        steps,
        *,
        size=(100, 30),
        environment=None,
        prepare=None,
        command=ARMODAL,
        panes=SHIPPED_PANES,
    ):
        path = tmp_path / "s.h5"
        if prepare is not None:
            prepare(path)

        async def main():
            app = ReviewApp(
                path,
                opened=replace(opened, path=path),
                clock=clock,
                environment=environment or {},
                command=command,
                panes=panes,
            )
            async with app.run_test(size=size, message_hook=notices) as pilot:
                await app.workers.wait_for_complete()  # read, every posture fitted, picks taken
                await pilot.pause()
                await steps(app, pilot)
            return app

        return asyncio.run(main())

    return run
