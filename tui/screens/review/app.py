"""The review app: one session, and the screens found in `panes`."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any, ClassVar

from textual import work
from textual.app import SystemCommand
from textual.binding import Binding, BindingType
from textual.events import Resize
from textual.markup import escape
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static, TabbedContent, TabPane

from armodal.protocols.errors import ArmodalError
from armodal.tui.screens.every_action import every_action
from armodal.tui.screens.key_line import KeyLine
from armodal.tui.screens.printable_app import PrintableApp
from armodal.tui.screens.review.background_report import write_report_in_background
from armodal.tui.screens.review.command_run import ARMODAL
from armodal.tui.screens.review.leaving import Leaving
from armodal.tui.screens.review.measuring import Measuring
from armodal.tui.screens.review.next_test import NextRun
from armodal.tui.screens.review.pane import PaneParts, ReviewPane, review_panes
from armodal.tui.screens.review.panes.gap import GapPane, read_gap
from armodal.tui.screens.review.panes.poles import StabilisationPicture
from armodal.tui.screens.review.picked_file import picked_path, read_picked, write_picked
from armodal.tui.screens.review.posture_view import (
    OpenSession,
    PostureView,
    automatic_again,
    fit_automatic,
    fit_picked,
    open_session,
)
from armodal.tui.screens.review.recovery_hint import recovery_hint
from armodal.tui.screens.review.run_pane import RunPane
from armodal.tui.screens.review.state import ReviewState
from armodal.tui.screens.themes import register_themes, use_next_theme

__all__ = ["ReviewApp"]

DIGITS = "123456789"  # keys of the first panes; the others are reached by the line of tabs
LEAST_COLUMNS, LEAST_ROWS = 60, 16


class ReviewApp(PrintableApp[int]):
    """Looks at a session's FRFs, modes and results.

    Parameters
    ----------
    path
        Session file.
    gap
        Result of `armodal gap --json` to show; by default the one kept beside the session.
    band_hz
        Lines looked at; all by default.
    opened
        A session already read, in place of the file; postures fitted already stay as they are.
    clock
        Seconds, for what moves.
    environment
        Where NO_COLOR is looked up.
    command
        How armodal is started for what takes long.
    panes
        The screens, by name; by default all of the folder `panes`.

    Attributes
    ----------
    problem
        Why the session cannot be shown.
    next_run
        What is to be measured after the app has been left; None: nothing.
    """

    TITLE = "armodal review"
    CSS = """
    #status { height: 1; background: $panel; color: $foreground; text-style: bold; padding: 0 1; }
    #trouble, #small { padding: 1 2; display: none; } #small { padding: 0 1; text-style: bold; }
    TabbedContent { height: 1fr; } TabPane { padding: 0; } ModesTable { height: 1fr; }
    App.-small { TabbedContent, KeyLine, #status { display: none; } #small { display: block; } }
    .result { width: 1fr; height: auto; padding: 0 1; }
    ModelNotes { height: auto; max-height: 40%; padding: 0 1; color: $warning; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left_square_bracket", "posture(-1)", "posture", key_display="[]"),
        Binding("right_square_bracket", "posture(1)", "next posture", show=False),
        Binding("s", "save", "save picks", show=False),
        Binding("w", "report", "report"),
        Binding("t", "next_theme", "theme", show=False),
        Binding("question_mark", "help", "help"),
        Binding("q", "leave", "leave"),
    ]

    def __init__(
        self,
        path: Path,
        *,
        gap: Path | None = None,
        band_hz: tuple[float, float] | None = None,
        opened: OpenSession | None = None,
        clock: Callable[[], float] = monotonic,
        environment: Mapping[str, str] = os.environ,
        command: tuple[str, ...] = ARMODAL,
        panes: Mapping[str, ReviewPane] | None = None,
    ) -> None:
        super().__init__()
        self.path, self.gap_file, self.band_hz = path, gap, band_hz
        self.problem: ArmodalError | None = None
        self.next_run: NextRun | None = None
        self._opened, self._clock = opened, clock
        self._environment, self._command = environment, command
        self._panes = review_panes() if panes is None else panes
        for digit, (tab, pane) in zip(DIGITS, self._panes.items(), strict=False):
            self.bind(digit, f"tab('{tab}')", description=pane.title, show=False)
        self.state: ReviewState | None = None

    def compose(self) -> Iterable[Widget]:
        """One line of state, the screens, the keys."""
        yield from (Static("", id=name, markup=False) for name in ("status", "trouble", "small"))
        yield KeyLine()

    async def on_mount(self) -> None:
        """Read the session; what cannot be read is said on the screen."""
        register_themes(self, self._environment)
        self.begin()

    def begin(self) -> None:
        """Read the session, and say that it is being read."""
        self.say_status(f"reading {self.path.name} …")
        self._open()

    @work(thread=True)
    def _open(self) -> None:
        try:
            opened = self._opened or open_session(self.path, band_hz=self.band_hz)
        except ArmodalError as error:
            self.call_from_thread(self._show_trouble, error)
            return
        show: Any = self.show_session  # a coroutine: its end is waited for
        self.call_from_thread(show, opened)
        self._fit_all(opened)

    def _fit_all(self, opened: OpenSession) -> None:
        """Fit every posture in turn; runs in the thread that read the session."""
        try:
            kept = read_picked(picked_path(self.path), opened.session)
        except ArmodalError as error:
            kept = {}
            self.call_from_thread(self.notify, str(error), severity="error", timeout=20.0)
        for number, view in enumerate(opened.views):
            known = view.automatic is not None
            fitted = view if known else fit_automatic(opened.superset, view)
            if view.name in kept and fitted.automatic is not None:
                try:
                    fitted = fit_picked(opened.superset, replace(fitted, picks=kept[view.name]))
                except ArmodalError as error:
                    self.call_from_thread(self.notify, str(error), severity="error", timeout=20.0)
            if fitted is not view:  # what is known is shown already, and perhaps changed since
                self.call_from_thread(self._fitted, number, fitted)
        if kept:
            self.call_from_thread(
                self.notify,
                f"poles picked by hand in {', '.join(kept)}, from {picked_path(self.path).name}",
            )

    def _show_trouble(self, error: ArmodalError) -> None:
        self.problem = error
        self.say_status("this session cannot be shown")
        trouble = self.query_one("#trouble", Static)
        trouble.update(f"{error}\n\n{recovery_hint(self.path)}q leaves.")
        trouble.display = True

    async def show_session(self, opened: OpenSession) -> None:
        """Make the screens of a session that was read."""
        state = ReviewState.of(opened)
        self._read_gap(state)
        parts = PaneParts(state=state, clock=self._clock, command=self._command)
        tabs = TabbedContent(initial=next(iter(self._panes)))
        for number, (tab, pane) in enumerate(self._panes.items(), start=1):
            main, *beside = pane.make(parts)
            main.id = f"{tab}-main"
            tabs.compose_add_child(TabPane(f"{number} {pane.title}", main, *beside, id=tab))
        await self.mount(tabs, before="#trouble")
        self.state = state
        self.action_tab(next(iter(self._panes)))
        self.redraw()

    def _read_gap(self, state: ReviewState) -> None:
        kept = self.path.with_suffix(".gap.json")
        chosen = self.gap_file or (kept if kept.exists() else None)
        if chosen is None:
            return
        try:
            state.gap = read_gap(chosen)
        except ArmodalError as error:
            self.notify(str(error), severity="error", timeout=20.0, markup=False)

    def _fitted(self, number: int, view: PostureView) -> None:
        if self.state is not None:
            self.state.views[number] = view
            self.redraw()

    def redraw(self) -> None:
        """Show the state everywhere."""
        if self.state is None:
            return
        self.say_status(self.state.status())
        for tab in self.query(TabPane):
            _redraw(tab)

    def say_status(self, text: str) -> None:
        """Show one line above the screens."""
        self.query_one("#status", Static).update(text)

    def on_resize(self, event: Resize) -> None:
        """Say so when the window is too small."""
        small = event.size.width < LEAST_COLUMNS or event.size.height < LEAST_ROWS
        self.set_class(small, "-small")
        self.query_one("#small", Static).update(
            f"window {event.size.width} x {event.size.height} is too small, wanted "
            f"{LEAST_COLUMNS} x {LEAST_ROWS}: make it larger (q leaves)"
        )

    def on_tabbed_content_tab_activated(self, event: TabbedContent.TabActivated) -> None:
        """Give the keys to the screen that is shown."""
        _redraw(event.pane)
        event.pane.children[0].focus()

    def action_tab(self, tab: str) -> None:
        """Go to a screen."""
        for tabs in self.query(TabbedContent):
            tabs.active = tab
            self.query_one(f"#{tab}-main").focus()

    def action_posture(self, step: int) -> None:
        """Go to a neighbouring posture."""
        if self.state is not None:
            self.state.choose_posture(step)
            self.redraw()

    def on_stabilisation_picture_picks_changed(
        self, message: StabilisationPicture.PicksChanged
    ) -> None:
        """Note the picks; the model stays as it is until it is refitted."""
        if self.state is not None:
            view = self.state.view
            self.state.views[self.state.posture] = replace(view, picks=message.picks, changed=True)
            self.redraw()

    def on_stabilisation_picture_automatic(self) -> None:
        """Show the automatic choice again."""
        if self.state is None or self.state.view.automatic is None:
            return
        again = automatic_again(self.state.opened.superset, self.state.view)
        self._change_model(self.state.posture, again)

    def on_stabilisation_picture_refit(self) -> None:
        """Refit from the picks, beside the screen."""
        if self.state is not None and not self.state.view.problem:
            self.say_status("refitting …")
            self._refit(self.state.posture, self.state.view)

    @work(thread=True, exclusive=True, group="refit")
    def _refit(self, number: int, view: PostureView) -> None:
        if self.state is None:
            return
        try:
            fitted = fit_picked(self.state.opened.superset, view)
        except ArmodalError as error:
            self.call_from_thread(self.notify, str(error), severity="error", timeout=10.0)
            self.call_from_thread(self.redraw)
            return
        self.call_from_thread(self._change_model, number, fitted)

    def _change_model(self, number: int, view: PostureView) -> None:
        if self.state is None:
            return
        by_hand = view.by_hand or self.state.views[number].by_hand
        self.state.views[number] = view
        self.state.unsaved |= by_hand
        self.state.choose_mode(min(self.state.mode, max(self.state.n_modes - 1, 0)))
        self.redraw()
        kind, model = "by hand" if view.by_hand else "automatic", view.model
        count = 0 if model is None else len(model.modes)
        self.notify(f"{view.name}: {count} modes {kind}", markup=False)

    def on_run_pane_done(self, message: RunPane.Done) -> None:
        """Keep a result."""
        message.pane.keep(message.value)
        self.redraw()

    def on_gap_pane_planned(self, message: GapPane.Planned) -> None:
        """Ask whether the next test is measured now."""

        def answered(now: bool | None) -> None:
            if now:
                self.next_run = message.run
                self.action_leave()

        self.push_screen(Measuring(message.run), answered)

    def action_save(self) -> None:
        """Save the picks of postures fitted by hand beside the session, and say where."""
        if self.state is None:
            return
        if self.state.view.changed:
            self.notify("refit the picks first (r), then save", severity="warning")
            return
        if self._save():
            self.notify(f"picked poles saved: {picked_path(self.path)}", timeout=8.0, markup=False)

    def _save(self) -> bool:
        if self.state is None:
            return False
        picks = {view.name: view.picks for view in self.state.views if view.by_hand}
        try:
            write_picked(picked_path(self.path), self.state.opened.session, picks)
        except ArmodalError as error:
            self.notify(str(error), severity="error", timeout=15.0, markup=False)
            return False
        self.state.unsaved = False
        self.redraw()
        return True

    @work(exclusive=True, group="report")
    async def action_report(self) -> None:
        """Write the report beside the session, and say where."""
        await write_report_in_background(self, self.path, self._command)

    def action_next_theme(self) -> None:
        """Use the next of armodal's themes."""
        use_next_theme(self)
        self.redraw()

    def action_help(self) -> None:
        """Show help on the screen in use, or hide it."""
        if self.screen.query("HelpPanel"):
            self.action_hide_help_panel()
        else:
            self.action_show_help_panel()

    def action_leave(self) -> None:
        """Leave; with picks not saved, ask."""
        if self.state is None or not self.state.unsaved:
            self.exit(0)
            return
        self.push_screen(Leaving(picked_path(self.path).name), self._left)

    def _left(self, answer: str | None) -> None:
        if answer == "leave" or (answer == "save" and self._save()):
            self.exit(0)
        else:
            self.next_run = None

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Textual's commands, every key that does something now, and the postures."""
        yield from super().get_system_commands(screen)
        yield from every_action(self, screen)
        if self.state is None:
            return
        for number, view in enumerate(self.state.views):
            yield SystemCommand(
                f"Posture {escape(view.name)}",
                "Look at this posture",
                lambda step=number - self.state.posture: self.action_posture(step),
            )


def _redraw(tab: TabPane) -> None:
    """Have each widget of a tab that can be redrawn do so."""
    for widget in tab.children:
        redraw = getattr(widget, "redraw", None)
        if callable(redraw):
            redraw()
