"""What shows each wish: home, measuring, review, demo, each loaded where it is wanted."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from armodal import SOFTWARE
from armodal.hil_sim.board_id import BOARD_ID
from armodal.protocols.session.journal import read_journal
from armodal.tui.console import err, say, say_next
from armodal.tui.journey import Step, travel
from armodal.tui.screens.wishes import Demonstrate, GoHome, Look, Measure, OwnArm, Wish
from armodal.tui.this_system import check_runs_devices, runs_devices

if TYPE_CHECKING:
    from armodal.tui.screens.review.app import ReviewApp

__all__ = ["STEPS", "go_from", "wish_after_review"]


def go_from(first: Wish) -> int:
    """Go on from screen to screen until one is left without a wish; return the exit code.

    Raises
    ------
    ArmodalError
        If what is wished first cannot be shown.
    """
    return travel(first, STEPS)


def _home(wish: GoHome) -> tuple[int, Wish | None]:
    home = import_module("armodal.tui.screens.home.app")
    app = home.HomeApp(
        Path.cwd(), measures=runs_devices(), ports=_ports, said=wish.said, arm_made=wish.arm_made
    )
    wished: Wish | None = app.run()
    return 0, wished


def _ports() -> list[tuple[str, str]]:
    found = import_module("armodal.daq.ports").find_ports()
    return [(port.path, port.description) for port in found]


def _look(wish: Look) -> tuple[int, Wish | None]:
    review = import_module("armodal.tui.screens.review.app")
    app = review.ReviewApp(wish.session, gap=wish.gap, band_hz=wish.band_hz)
    app.run()
    return wish_after_review(app)


def wish_after_review(app: ReviewApp) -> tuple[int, Wish | None]:
    """Return exit code and wish of a review that has been left.

    Raises
    ------
    ArmodalError
        If the session could not be shown.
    """
    if app.problem is not None:
        raise app.problem
    if app.next_run is None:
        say_next(f"report {app.path}")
        return app.return_code or 0, None
    wanted = app.next_run
    return 0, Measure(
        journal=wanted.journal,
        arm=wanted.arm,
        plan=str(wanted.plan),
        simulated=wanted.simulated,
        earlier=app.path,
    )


def _measure(wish: Measure) -> tuple[int, Wish | None]:
    """Run the operator's app, which is loaded where it is wanted: not on every system."""
    check_runs_devices("run")
    arm, simulated, time_scale = wish.arm, wish.simulated, 1.0
    if wish.plan is None:
        header = read_journal(wish.journal).header
        arm, time_scale = header.arm, header.time_scale
        simulated = header.dictionary.board_id == BOARD_ID
    code, then = import_module("armodal.tui.commands.run").run_app(
        plan=wish.plan,
        arm=arm,
        session=wish.journal,
        simulated=simulated,
        measured_by=wish.measured_by,
        earlier=wish.earlier,
        time_scale=time_scale,
    )
    return int(code), then


def _demonstrate(wish: Demonstrate) -> tuple[int, Wish | None]:
    check_runs_devices("demo")
    say(f"the demo takes two to three minutes; Ctrl-C stops it; it goes into {wish.folder}")
    demo = import_module("armodal.tui.command_parts.demo_run")
    count = import_module("armodal.tui.hit_count").HitCount(err)
    try:
        found, _, gap = demo.run_demo(wish.folder, seed=1, software=SOFTWARE, show=count, say=say)
    except KeyboardInterrupt:
        return 130, GoHome(said="the demo was stopped")
    err.print(gap.summary)
    return 0, Look(session=Path(found["session"]))


def _make_arm(wish: OwnArm) -> tuple[int, Wish | None]:
    """Make an arm file as `armodal arm new` does, with its questions."""
    arm = import_module("armodal.tui.commands.arm")
    folder = wish.folder / wish.description.name.split(".")[0]
    try:
        arm.new_command(wish.description, folder)
        err.input("Enter: back to the home screen ")
    except (typer.Abort, KeyboardInterrupt, EOFError):
        return 130, GoHome(said="no arm was made")
    made = next(path for path in sorted(folder.glob("*.toml")) if path.name != "plan.toml")
    return 0, GoHome(arm_made=made.relative_to(wish.folder))


STEPS: dict[type, Step] = {
    GoHome: _home,
    Look: _look,
    Measure: _measure,
    Demonstrate: _demonstrate,
    OwnArm: _make_arm,
}
