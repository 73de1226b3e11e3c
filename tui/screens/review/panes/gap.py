"""Gap: what the model lacks, and the next test as a plan file by one key."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar

from rich.console import RenderableType
from textual.binding import Binding, BindingType
from textual.message import Message

from armodal.analyzer.report import gap_path
from armodal.protocols.errors import ArmodalError, SessionError
from armodal.protocols.os_words import os_words
from armodal.tui.screens.review.gap_text import gap_view
from armodal.tui.screens.review.next_test import NextRun, keep_plan, next_run, next_test_plan
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.run_pane import RunPane

__all__ = ["PANE", "GapPane", "read_gap"]

_LIMIT = 64 * 1024 * 1024
_NOT_SHOWN = (
    TypeError,
    ValueError,
    AttributeError,
    KeyError,
    IndexError,
    OverflowError,
    RecursionError,
)


def read_gap(path: Path) -> dict[str, Any]:
    """Read what `armodal gap --json` wrote.

    Raises
    ------
    SessionError
        If the file is not such an object, or cannot be shown.
    """
    try:
        size = path.stat().st_size
        value = json.loads(path.read_text(encoding="utf-8")) if size <= _LIMIT else None
    except OSError as error:
        raise SessionError(
            f"{path}: {os_words(error)}; give the result of `armodal gap`"
        ) from error
    except (ValueError, RecursionError) as error:
        raise SessionError(
            f"{path}: wanted JSON, got {error}; give the result of `armodal gap`"
        ) from error
    if not isinstance(value, dict) or "verdict" not in value:
        raise SessionError(
            f"{path}: wanted an object with a verdict, got something else; give the result of "
            "`armodal gap --json`"
        )
    try:
        gap_view(value)
    except _NOT_SHOWN as error:
        raise SessionError(
            f"{path}: wanted the values that `armodal gap --json` writes, got others ({error}); "
            "give the result of `armodal gap`"
        ) from error
    return value


class GapPane(RunPane):
    """Runs `armodal gap` beside the app, or shows its result from a file."""

    HELP = """# Gap
`enter` looks for what the model lacks, `escape` stops it. The verdict is one of four: named,
ambiguous, nothing detectable, outside the library. The map says where model and measurement
disagree, 1 being what scatter explains. The result is kept beside the session. `n` writes the
proposed next test as a plan file beside the session and asks whether to measure it now: `n` or
`enter` leaves review and begins `armodal run` with that plan.
"""
    BINDINGS: ClassVar[list[BindingType]] = [Binding("n", "plan", "next test → run")]
    name_of_command = "gap"

    class Planned(Message):
        """The next test is a plan file, and can be measured."""

        def __init__(self, run: NextRun) -> None:
            super().__init__()
            self.run = run

    def introduction(self) -> str:
        """Say what enter does."""
        return (
            "enter: find where model and measurement disagree, and what the model lacks\n"
            f"The result is kept beside the session as {gap_path(self.state.opened.path).name} "
            "and shown here at once the next time."
        )

    def keep(self, value: dict[str, Any]) -> None:
        """Keep it for all screens."""
        self.state.gap = value

    def result(self) -> RenderableType | None:
        """Verdict and all it stands on."""
        found = self.state.gap
        return None if found is None else gap_view(found)

    def plan_path(self) -> Path:
        """Where the next test's plan goes."""
        path = self.state.opened.path
        return path.with_name(f"{path.stem}-next-test.toml")

    def action_plan(self) -> None:
        """Write the next test as a plan file, and offer to measure it; another file stays."""
        path, session = self.plan_path(), self.state.opened.session
        try:
            keep_plan(next_test_plan(session, self.state.gap), path)
        except ArmodalError as error:
            self.app.notify(str(error), severity="error", timeout=10.0, markup=False)
        else:
            self.post_message(self.Planned(next_run(session, path)))


PANE = ReviewPane(
    title="Gap", place=8, make=lambda parts: (GapPane(parts.state, command=parts.command),)
)
