import asyncio
from dataclasses import dataclass, replace

import pytest
from support.offline_lab import simulate_session

from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.review.posture_view import fit_automatic, opened_session


@pytest.fixture(scope="session")
def session():
    return simulate_session(4, hits_per_point=2)


@pytest.fixture(scope="session")
def opened(session, tmp_path_factory):
    """Every posture fitted once for all tests."""
    read = opened_session(tmp_path_factory.mktemp("opened") / "s.h5", session)
    return replace(read, views=tuple(fit_automatic(read.superset, view) for view in read.views))


@dataclass
class Clock:
    now: float = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def drive(opened, tmp_path, clock):
    """Runs a coroutine function of (app, pilot) on the app with every posture fitted."""

    def run(steps, *, size=(100, 30), environment=None, prepare=None):
        path = tmp_path / "s.h5"
        if prepare is not None:
            prepare(path)

        async def main():
            app = ReviewApp(
                path,
                opened=replace(opened, path=path),
                clock=clock,
                environment=environment or {},
            )
            async with app.run_test(size=size) as pilot:
                while app.state is None or any(
                    view.model is None and not view.problem for view in app.state.views
                ):
                    await pilot.pause(0.02)
                await pilot.pause()
                await steps(app, pilot)
            return app

        return asyncio.run(main())

    return run


@pytest.fixture
def screen_text():
    """Reads what the screen of an app shows, row by row."""

    def read(app):
        return "\n".join(
            "".join(segment.text for segment in strip)
            for strip in app.screen._compositor.render_strips()
        )

    return read
