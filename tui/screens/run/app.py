"""The operator's app: keys to wishes, state to screens."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, ClassVar

from textual import events
from textual.app import SystemCommand
from textual.binding import Binding, BindingType
from textual.screen import Screen
from textual.worker import Worker

from armodal.daq.events import (
    Failed,
    Finished,
    HitJudged,
    HitWithdrawn,
    Noted,
    PointMoved,
    Prompted,
    SessionOpened,
)
from armodal.daq.session_machine import PromptKind
from armodal.tui.screens.every_action import every_action
from armodal.tui.screens.printable_app import PrintableApp
from armodal.tui.screens.run.ask_angles import AnglesScreen
from armodal.tui.screens.run.ask_mass import MassScreen
from armodal.tui.screens.run.ask_move import MoveScreen
from armodal.tui.screens.run.collector import CalmCollector
from armodal.tui.screens.run.conductor import Conductor
from armodal.tui.screens.run.confirmed import CONFIRMED
from armodal.tui.screens.run.engine import Engine
from armodal.tui.screens.run.happenings import HandIdle, Happening, SensorsConfirmed
from armodal.tui.screens.run.help import HelpScreen
from armodal.tui.screens.run.keys import ACTIONS, works
from armodal.tui.screens.run.operator_screen import (
    OperatorScreen,
    needed_screen,
    operator_screens,
)
from armodal.tui.screens.run.options import RunOptions
from armodal.tui.screens.run.state import Phase, RunState
from armodal.tui.screens.run.step_screen import StepScreen
from armodal.tui.screens.run.steps.progress import ProgressScreen
from armodal.tui.screens.wishes import Look

__all__ = ["RunApp"]

PROGRESS = "progress"
REDRAW_WALL_S = 0.08  # the live views are to come ten times a second, under load too
SEEN_AT_ONCE = (HitJudged, HitWithdrawn, Prompted, Failed, Finished, SensorsConfirmed)


class RunApp(PrintableApp[int]):
    """Guide the operator from the laboratory through postures, points and hits.

    Parameters
    ----------
    options
        Ports, session, simulation.
    clock
        Wall seconds.
    make_engine
        Makes the line to the processes from what is to be told of every event.
    screens
        The screens, by name; by default all of the folder `steps`.

    Attributes
    ----------
    wish
        The session to be looked at once the app has been left; None: nothing.
    """

    TITLE = "armodal run"
    CSS_PATH = "run.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "go_on", "Go on", priority=True, tooltip="go on, as the screen says"),
        Binding("e", "angles", "Type angles", tooltip="type the joint angles read"),
        Binding("m", "move", "Move", tooltip="move the point in hand"),
        Binding("h", "hand", "Hand", tooltip="the simulated hand does it"),
        Binding("s", "simulate", "Simulate", tooltip="simulated laboratory"),
        Binding("a", "take_trigger", "Trigger", tooltip="take the suggested trigger level"),
        Binding("c", "mass", "Mass", tooltip="calibrate on a known mass"),
        Binding("t", "retake", "Retake", tooltip="start the point over"),
        Binding("k", "skip", "Skip", tooltip="skip the point"),
        Binding("u", "undo", "Undo", tooltip="take the last accepted hit back"),
        *(
            Binding(screen.key, f"call('{name}')", screen.words)
            for name, screen in operator_screens().items()
            if screen.key
        ),
        Binding("r", "again", "Try again", tooltip="try again after a stop"),
        Binding("b", "ring", "Bell", tooltip="bell at every verdict"),
        Binding("question_mark,f1", "help", "Help", key_display="?", tooltip="this help"),
        Binding("q", "leave", "Leave", tooltip="leave; go on another time"),
        Binding("ctrl+q", "leave", "Leave", show=False),
    ]

    def __init__(
        self,
        options: RunOptions,
        clock: Callable[[], float] = time.monotonic,
        make_engine: Callable[[Callable[[Happening], None]], Engine] = Engine,
        screens: Mapping[str, OperatorScreen] | None = None,
    ) -> None:
        super().__init__()
        self.conductor = Conductor(options, self._changed, clock, make_engine)
        self._clock = clock
        self._collector = CalmCollector()
        self._screens = operator_screens() if screens is None else screens
        self._steps: dict[str, StepScreen] = {}
        self._called: str | None = None  # the screen the operator has called by its key
        self._bell = False
        self._stale = True
        self._deriving: Worker[None] | None = None
        self._offered: tuple[bool, ...] = ()
        self.wish: Look | None = None

    @property
    def state(self) -> RunState:
        """What the screens show."""
        return self.conductor.state

    async def on_mount(self) -> None:
        """Show the laboratory, and begin."""
        self._steps = {name: screen.make() for name, screen in self._screens.items()}
        for name, screen in self._steps.items():
            self.install_screen(screen, name)  # kept when another one is shown
        # The screen that says how the session ended is ready when it ends.
        await self.push_screen(self._steps[PROGRESS])
        await self.switch_screen(self._steps[self._shown])
        self.set_interval(REDRAW_WALL_S, self._tick)
        self.run_worker(self.conductor.start())

    def on_unmount(self) -> None:
        """Hang up; what still runs finishes by itself."""
        self.conductor.close()
        self._collector.end()

    def _changed(self, event: Happening) -> None:
        self._stale = True
        if isinstance(event, HitJudged):
            self._collector.verdict_came(self._clock())
            if self._bell:
                self.bell()
        if isinstance(event, HandIdle) and event.trouble:
            self.notify(event.trouble, severity="error", markup=False)
        if isinstance(event, PointMoved):
            self.notify(f"Point {event.point} is moved; the journal keeps it.", markup=False)
        if isinstance(event, Noted) and not event.text.startswith(CONFIRMED):
            self.notify(event.text, severity="warning", markup=False)
        if isinstance(event, HitJudged | Failed):
            self._called = None
            if self.screen_stack and isinstance(self.screen, HelpScreen):
                self.pop_screen()  # the verdict lies beneath
        if isinstance(event, SessionOpened):
            self._collector.begin(self._clock())
        if isinstance(event, Prompted) and event.prompt.kind is not PromptKind.HIT:
            self._collector.pause_came(self._clock())
        if isinstance(event, Finished) and self.state.phase is Phase.ENDED:
            self._deriving = self.run_worker(self._derive())
        if isinstance(event, SEEN_AT_ONCE):
            self.redraw()

    async def _derive(self) -> None:
        """Derive the session file, once the screen has said how the session ended."""
        for _ in range(2):  # a screen shown for the first time is composed, and then drawn
            await self.screen.wait_for_refresh()
        await self.conductor.derive()

    def _tick(self) -> None:
        self.conductor.tick()
        self.redraw()
        self._collector.turn(self._clock())

    def redraw(self) -> None:
        """Show the screen the state asks for, if it has changed."""
        if not self._steps or not self.screen_stack or not isinstance(self.screen, StepScreen):
            return
        wanted = self._steps[self._shown]
        if self.screen is not wanted:
            self.switch_screen(wanted)
            wanted.show(self.state)
        elif self._stale:
            wanted.show(self.state)
        self._stale = False
        offered = tuple(
            works(name, self.state, overview=self._called is not None) for name in ACTIONS
        )
        if offered != self._offered:
            self._offered = offered
            self.refresh_bindings()

    @property
    def _shown(self) -> str:
        """Name of the screen that is to be seen."""
        stopped = self.state.phase in {Phase.FAILED, Phase.ENDED}
        if self._called is not None and not stopped:
            return self._called
        return needed_screen(self.state, self._screens)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer only the keys that do something now."""
        if action == "call" and parameters[0] not in self._screens:
            return False
        if action in ACTIONS and not isinstance(self.screen, StepScreen):
            return False  # a dialogue has the keys
        return works(action, self.state, overview=self._called is not None)

    def takes_key(self, key: str) -> bool:
        """Whether a key is a digit of the list of ports."""
        return key.isdigit() and self.state.phase is Phase.LAB

    def on_key(self, event: events.Key) -> None:
        """Take digits: the ports of the list."""
        if self.takes_key(event.key):
            self.conductor.choose_port(int(event.key))

    async def action_go_on(self) -> None:
        """Enter: what it means is said on the screen."""
        if self._called is not None:
            screen = self._steps[self._called]
            self._called = None
            place = screen.chosen if isinstance(screen, ProgressScreen) else None
            if place is not None and place != self.state.here:
                self.conductor.retake(place)
            self.redraw()
        elif self.state.phase is Phase.ENDED and self.state.session_file is not None:
            self.wish = Look(session=Path(self.state.session_file))
            await self.action_leave()
        else:
            self.run_worker(self.conductor.go_on())

    def action_angles(self) -> None:
        """Type the joint angles read."""
        self.push_screen(AnglesScreen(len(self.state.arm.joints)), self._typed)

    def _typed(self, joints_deg: tuple[float, ...] | None) -> None:
        if joints_deg is not None:
            self.conductor.tell_angles(joints_deg)

    def action_move(self) -> None:
        """Put the point in hand elsewhere on its link."""
        here = self.state.here
        if here is not None:
            self.push_screen(MoveScreen(self.state.arm, here[1]), self._moved)

    def _moved(self, typed: str | None) -> None:
        if typed is not None:
            self.run_worker(self.conductor.move_point(typed))

    def action_hand(self) -> None:
        """Have the simulated hand do what is asked."""
        self.conductor.hand()

    def action_simulate(self) -> None:
        """Start the simulated laboratory."""
        self.run_worker(self.conductor.simulate())

    def action_take_trigger(self) -> None:
        """Take the trigger level that the trial hits suggest."""
        self.conductor.take_trigger()

    def action_mass(self) -> None:
        """Calibrate on a known mass, or be done with it."""
        if self.state.mass_kg is not None:
            self.conductor.choose_mass(None)
        else:
            self.push_screen(MassScreen(), self.conductor.choose_mass)

    def action_retake(self) -> None:
        """Start the point in hand over."""
        self.conductor.retake()

    def action_skip(self) -> None:
        """Leave the point in hand."""
        self.conductor.skip()

    def action_undo(self) -> None:
        """Take the last accepted hit back."""
        self.conductor.undo()

    def action_call(self, name: str) -> None:
        """Look at a screen, and back."""
        self._called = None if self._called == name else name
        self._stale = True
        self.redraw()

    def action_again(self) -> None:
        """Go on after a stop."""
        self.run_worker(self.conductor.again())

    def action_ring(self) -> None:
        """Ring at every verdict, or no more."""
        self._bell = not self._bell
        self.notify("The bell rings at every verdict." if self._bell else "The bell is off.")

    def action_help(self) -> None:
        """Show what the keys do."""
        own = [one for one in self.BINDINGS if isinstance(one, Binding) and one.tooltip]
        keys = [(self.get_key_display(one), one.tooltip) for one in own]
        called = [(one.key, one.words.lower()) for one in self._screens.values() if one.key]
        self.push_screen(HelpScreen(keys + called))

    async def action_leave(self) -> None:
        """Leave; what was accepted is in the journal, and the session can be gone on with."""
        self.notify("Leaving: the journal is being closed, the session file written.")
        self.run_worker(self._leave(), group="leave", exclusive=True)

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Textual's commands, and every key that does something now."""
        yield from super().get_system_commands(screen)
        yield from every_action(self, screen)

    async def _leave(self) -> None:
        """Leave once all is written; the screen says meanwhile what is under way."""
        await self.conductor.leave()
        if self._deriving is not None:
            await self._deriving.wait()
        self.exit(0)
