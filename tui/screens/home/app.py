"""The home screen, from which all others are reached."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.screen import Screen
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from armodal.tui.screens.every_action import every_action
from armodal.tui.screens.home.choice import HomeParts, home_choices
from armodal.tui.screens.home.found_sessions import FoundSession, find_sessions
from armodal.tui.screens.key_line import KeyLine
from armodal.tui.screens.printable_app import PrintableApp
from armodal.tui.screens.themes import register_themes
from armodal.tui.screens.wishes import Look, Measure, Wish

__all__ = ["HomeApp"]


class HomeApp(PrintableApp[Wish]):
    """Sessions of a folder, and what else can be begun; returns where to go on.

    Parameters
    ----------
    folder
        Where sessions are looked for and new ones go.
    measures
        Whether devices run on this system.
    ports
        Serial ports of this machine: (path, description) of each.
    said
        What to say first: why something came to nothing.
    arm_made
        Arm file just made: a new session is begun with it.
    environment
        Where NO_COLOR is looked up.
    """

    TITLE = "armodal"
    CSS = """
    #head { padding: 0 1; text-style: bold; background: $panel; height: 1; }
    #what { padding: 0 1; height: auto; }
    OptionList { height: 1fr; border: none; padding: 0 1; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "open", "open", show=True, priority=False),
        Binding("r", "resume", "resume"),
        *(
            Binding(one.key, f"choose('{name}')", one.label, show=one.in_key_line)
            for name, one in home_choices().items()
        ),
        Binding("q", "quit", "leave"),
    ]

    def __init__(
        self,
        folder: Path,
        *,
        measures: bool,
        ports: Callable[[], Sequence[tuple[str, str]]],
        said: str = "",
        arm_made: Path | None = None,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        super().__init__()
        self._said, self._arm_made = said, arm_made
        self._folder, self._measures, self._ports = folder, measures, ports
        self._environment = environment
        self._found: tuple[FoundSession, ...] = ()

    def compose(self) -> ComposeResult:
        """What is there, and what can be begun."""
        yield Static(f"armodal   {self._folder}", id="head", markup=False)
        yield OptionList(markup=False)
        yield KeyLine()

    def on_mount(self) -> None:
        """List the sessions."""
        register_themes(self, self._environment)
        self._found = find_sessions(self._folder)
        choices = self.query_one(OptionList)
        choices.add_options(
            Option(_line(one, self._folder), id=f"session-{number}")
            for number, one in enumerate(self._found)
        )
        if not self._found:
            choices.add_option(Option("no session in this folder yet", disabled=True))
        choices.add_option(None)
        choices.add_options(
            Option(f"{one.key}  {one.words}", id=name)
            for name, one in home_choices().items()
            if self._measures or not one.measures
        )
        choices.add_option(Option("q  leave", id="leave"))
        choices.focus()
        choices.action_first()
        if self._said:
            self.notify(self._said, severity="error", timeout=20.0, markup=False)
        if self._arm_made is not None:
            made = self._arm_made
            self.notify(
                f"arm file {made}: check what {made.with_name('README.md')} lists, then n or s "
                "begins a session with it",
                timeout=20.0,
                markup=False,
            )

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Go where the line says."""
        name = event.option.id or ""
        if name.startswith("session-"):
            self._open(self._found[int(name.removeprefix("session-"))])
        elif name == "leave":
            self.exit()
        else:
            self.action_choose(name)

    def _open(self, one: FoundSession) -> None:
        if one.path.suffix == ".journal":
            self._resume(one.path)
        else:
            self.exit(Look(session=one.path))

    def _resume(self, journal: Path) -> None:
        if self._measures:
            # Arm, plan and laboratory are as the journal has them.
            self.exit(Measure(journal=journal, arm="", plan=None, simulated=False))
        else:
            self.notify(
                "measuring is not supported on this operating system; "
                f"read what was captured: armodal recover {journal}"
            )

    def action_open(self) -> None:
        """Open what the cursor is on."""
        self.query_one(OptionList).action_select()

    def action_resume(self) -> None:
        """Go on with the session under the cursor, or with the newest that is not finished."""
        at = self.query_one(OptionList).highlighted
        here = self._found[at : at + 1] if at is not None else ()
        journals = [one.unfinished for one in (*here, *self._found) if one.unfinished is not None]
        if journals:
            self._resume(journals[0])
        else:
            self.notify("every session here is finished: Enter looks at one, n begins a new one")

    def action_choose(self, name: str) -> None:
        """Begin what a line of the list says."""
        parts = HomeParts(app=self, folder=self._folder, ports=self._ports, arm_made=self._arm_made)
        home_choices()[name].chosen(parts)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer to measure only where devices run."""
        if self._measures:
            return True
        return action != "resume" and not (
            action == "choose" and home_choices()[str(parameters[0])].measures
        )

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Textual's commands and every key."""
        yield from super().get_system_commands(screen)
        yield from every_action(self, screen)


def _line(one: FoundSession, folder: Path) -> str:
    when = one.changed.strftime("%Y-%m-%d %H:%M")
    state = "" if one.unfinished is None else "   not finished: r goes on with it"
    return f"{when}  {one.path.relative_to(folder)}{state}"
