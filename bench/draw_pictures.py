"""Draw the pictures of the documentation: both apps by keys, the operator's in the simulated lab.

    python bench/draw_pictures.py [--only run|review] [--out docs/pictures]

Draw them again when a screen changes, and look at each.
"""

from __future__ import annotations

import argparse
import asyncio
import re
import sys
import tempfile
import time
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.offline_lab import simulate_session
from textual.pilot import Pilot

from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan
from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.review.posture_view import fit_automatic, opened_session
from armodal.tui.screens.run.app import RunApp
from armodal.tui.screens.run.options import RunOptions
from armodal.tui.screens.run.place import find_place
from armodal.tui.screens.run.state import Step

DEADLINE_S = 60.0
TIME_SCALE = 3.0
RUN_SIZE, REVIEW_SIZE = (120, 36), (100, 30)
LOOK_EVERY_S = 0.05
FEWEST_TRIALS = 3
POINTS_DONE = 4  # before the picture of the progress


def clean(svg: str) -> str:
    """Return a screenshot without addresses of fonts, and with names that do not change."""
    svg = re.sub(r"<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r"@font-face \{.*?\}", "", svg, flags=re.DOTALL)
    svg = re.sub(r"terminal-\d+-", "t-", svg)
    return re.sub(r"font-family: Fira Code, monospace", "font-family: monospace", svg)


class Scene:
    """An app under a pilot, and the folder its pictures go to."""

    def __init__(self, app: Any, pilot: Pilot[int], folder: Path) -> None:
        self.app, self.pilot, self.folder = app, pilot, folder

    async def until(self, wanted: Callable[[], bool], what: str) -> None:
        """Wait for a condition, not for a time."""
        end_s = time.monotonic() + DEADLINE_S
        while not wanted():
            if time.monotonic() > end_s:
                raise SystemExit(f"waited {DEADLINE_S:g} s for {what}")
            await self.pilot.pause(LOOK_EVERY_S)

    async def press(self, *keys: str) -> None:
        """Press keys and let the screen follow."""
        await self.pilot.press(*keys)
        await self.pilot.pause()

    async def draw(self, name: str, *, at_once: bool = False) -> None:
        """Write the screen, as it is now or once no message lies over it."""
        if not at_once:
            await self.until(lambda: not self.app.screen.query("Toast"), "the messages to go")
        for _ in range(3):  # words first, pictures after them
            await self.pilot.pause(0.1)
        path = self.folder / f"{name}.svg"
        path.write_text(clean(self.app.export_screenshot(title=self.app.title)), encoding="utf-8")
        sys.stdout.write(f"{path}\n")


async def play(
    app: Any, size: tuple[int, int], folder: Path, body: Callable[[Scene], Awaitable[None]]
) -> None:
    """Run an app and a scene on it."""
    async with app.run_test(size=size) as pilot:
        await body(Scene(app, pilot, folder))


async def run_pictures(scene: Scene) -> None:
    """From the laboratory to the progress of a session."""
    app = scene.app

    def idle() -> bool:
        return app.state.hand_doing is None

    async def hand() -> None:
        await scene.press("h")
        await scene.until(idle, "the simulated hand")

    def known() -> bool:
        health = app.state.health
        return health is not None and health.clock_uncertainty_s is not None

    await scene.until(lambda: known() and app.state.posture_known, "the laboratory")
    while len(app.state.trials) < FEWEST_TRIALS:
        await hand()
        await scene.pilot.pause(1.0)
    await scene.draw("run-lab")
    await scene.press("enter")
    await scene.press("enter")
    await scene.until(lambda: app.state.step is Step.POSTURE, "the first posture")
    await hand()
    await scene.until(lambda: app.state.prompt.kind.value == "point", "the posture reached")
    await scene.draw("run-posture")
    await scene.press("enter")
    await scene.until(lambda: app.state.step is Step.POINT, "the first point")
    await scene.draw("run-point")
    await measure_points(scene, hand)
    await scene.press("k", "g")
    await scene.draw("run-progress")


async def measure_points(scene: Scene, hand: Callable[[], Awaitable[None]]) -> None:
    """Hit some points, and draw the second hit of the second one."""
    app = scene.app
    drawn = False

    def done() -> int:
        return sum(p.complete for p in app.state.progress)

    while done() < POINTS_DONE:
        if app.state.step is Step.POINT:
            await hand()
            await scene.press("enter")
            await scene.until(lambda: app.state.step is Step.HIT, "the point to be ready")
        before = len(app.state.hits)
        await hand()
        await scene.pilot.pause(1.0)
        if len(app.state.hits) == before:
            continue
        last = app.state.last_hit.hit.verdict
        if not drawn and last.accepted and done() == 1 and app.state.prompt.accepted == 2:
            drawn = True
            await scene.draw("run-hit", at_once=True)  # with the hit in the live views


async def review_pictures(scene: Scene) -> None:
    """FRF, poles and a structural mode."""
    app = scene.app
    await scene.until(
        lambda: app.state is not None and all(view.model for view in app.state.views), "the modes"
    )
    await scene.press("1", "a", "down", "down")
    await scene.draw("review-frf")
    await scene.press("3")
    await scene.draw("review-poles")
    await scene.press("6", "n", "n", "n", "l")
    await scene.draw("review-shape")


def draw_run(folder: Path) -> None:
    """Draw the operator's app."""
    arm = load_arm("rv4frl")
    plan = load_plan("rv4frl-three-postures", arm)
    with tempfile.TemporaryDirectory() as home:
        place = find_place(Path(home) / "session.journal", arm, plan)
        app = RunApp(RunOptions(place=place, simulated=True, time_scale=TIME_SCALE))
        asyncio.run(play(app, RUN_SIZE, folder, run_pictures))


def draw_review(folder: Path) -> None:
    """Draw the review app."""
    path = Path("session.h5")
    opened = opened_session(path, simulate_session(4, hits_per_point=2))
    views = tuple(fit_automatic(opened.superset, view) for view in opened.views)
    app = ReviewApp(
        path,
        opened=replace(opened, views=views),
        clock=lambda: 0.0,  # what moves stands still
        environment={},
    )
    asyncio.run(play(app, REVIEW_SIZE, folder, review_pictures))


def main() -> None:
    """Draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", choices=["run", "review"])
    parser.add_argument("--out", type=Path, default=Path("docs/pictures"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    if given.only != "review":
        draw_run(given.out)
    if given.only != "run":
        draw_review(given.out)


if __name__ == "__main__":
    main()
