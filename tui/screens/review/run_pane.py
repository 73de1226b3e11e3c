"""A screen that runs a long command and shows its progress, then its result."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import Any, ClassVar

from rich.console import RenderableType
from rich.text import Text
from textual import work
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.message import Message
from textual.widgets import Static

from armodal.protocols.errors import ArmodalError
from armodal.tui.screens.review.command_run import ARMODAL, CommandRun
from armodal.tui.screens.review.state import ReviewState

__all__ = ["RunPane"]


class RunPane(VerticalScroll, can_focus=True):
    """Start, progress, stop; what the result looks like is the subclass's."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "start", "start"),
        Binding("escape", "stop", "stop"),
    ]

    name_of_command = ""

    class Done(Message):
        """The command came to its end with this object."""

        def __init__(self, pane: RunPane, value: dict[str, Any]) -> None:
            super().__init__()
            self.pane = pane
            self.value = value

    def __init__(
        self,
        state: ReviewState,
        *,
        id: str | None = None,  # noqa: A002
        clock: Callable[[], float] = monotonic,
        command: tuple[str, ...] = ARMODAL,
    ) -> None:
        super().__init__(id=id)
        self.state = state
        self._clock = clock
        self._command = command
        self._run: CommandRun | None = None
        self._began_s = 0.0
        self._lines: list[str] = []
        self.problem = ""

    def compose(self) -> Any:
        """One text that holds everything."""
        yield Static("", classes="result")

    def on_mount(self) -> None:
        """Show how it stands, and keep the time while running."""
        self.set_interval(0.5, self._keep_time)
        self.redraw()

    def arguments(self) -> tuple[str, ...]:
        """What follows `armodal`."""
        return (self.name_of_command, str(self.state.opened.path), "--json")

    def introduction(self) -> str:
        """What is said before the first run."""
        raise NotImplementedError

    def result(self) -> RenderableType | None:
        """What is shown of the result; None before there is one."""
        raise NotImplementedError

    def keep(self, value: dict[str, Any]) -> None:
        """Keep the object that the command ended with, from where `result` takes it."""
        raise NotImplementedError

    @property
    def running(self) -> bool:
        """Whether the command runs."""
        return self._run is not None

    def redraw(self) -> None:
        """Show how it stands."""
        if not self.is_mounted:
            return
        shown: RenderableType
        if self._run is not None:
            seconds = self._clock() - self._began_s
            steps = [f"  {line}" for line in self._lines[-12:]]
            head = f"armodal {self.name_of_command} runs, {seconds:.0f} s  (escape stops it)"
            shown = Text("\n".join([head, *steps]))
        else:
            result = self.result()
            shown = Text(self.introduction()) if result is None else result
            if self.problem:
                shown = Text(f"{self.problem}\n\n{self.introduction()}")
        self.query_one(".result", Static).update(shown)

    def _keep_time(self) -> None:
        if self._run is not None:
            self.redraw()

    def action_start(self) -> None:
        """Start the command, unless it runs."""
        if self._run is None:
            self._lines, self.problem, self._began_s = [], "", self._clock()
            run = self._run = CommandRun(self.arguments(), self._lines.append, self._command)
            self.redraw()
            self._wait_for(run)

    def action_stop(self) -> None:
        """Stop the command."""
        if self._run is not None:
            self._run.stop()

    @work(exclusive=True)
    async def _wait_for(self, run: CommandRun) -> None:
        try:
            value = await run.result()
        except (ArmodalError, OSError) as error:
            self.problem = str(error)
        else:
            self.post_message(self.Done(self, value))
        finally:
            self._run = None
            self.redraw()

    def on_unmount(self) -> None:
        """Leave no process behind."""
        self.action_stop()
