"""Gap: what the model lacks, and the next test as a plan file by one key."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar

from rich.console import RenderableType
from textual.binding import Binding, BindingType
from typer.main import get_command

from protocols.errors import ArmodalError, SessionError
from tui.plan import write_plan
from tui.review.gap_text import gap_view
from tui.review.next_test import next_test_plan
from tui.review.run_pane import RunPane

__all__ = ["GapPane", "read_gap"]

_LIMIT = 64 * 1024 * 1024


def read_gap(path: Path) -> dict[str, Any]:
    """Read what `armodal gap --json` wrote.

    Raises
    ------
    SessionError
        If the file is not such an object.
    """
    try:
        size = path.stat().st_size
        value = json.loads(path.read_text(encoding="utf-8")) if size <= _LIMIT else None
    except OSError as error:
        raise SessionError(f"{path}: {error.strerror}; give the result of `armodal gap`") from error
    except ValueError as error:
        raise SessionError(
            f"{path}: wanted JSON, got {error}; give the result of `armodal gap`"
        ) from error
    if not isinstance(value, dict) or "verdict" not in value:
        raise SessionError(
            f"{path}: wanted an object with a verdict, got something else; give the result of "
            "`armodal gap --json`"
        )
    return value


class GapPane(RunPane):
    """Runs `armodal gap` beside the app, or shows its result from a file."""

    HELP = """# Gap
`enter` looks for what the model lacks, `escape` stops it. The verdict is one of four: named,
ambiguous, nothing detectable, outside the library. The map says where model and measurement
disagree, 1 being what scatter explains. `n` writes the proposed next test as a plan file beside
the session, for `armodal run`; `w` keeps the result as a file.
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n", "plan", "next test → plan"),
        Binding("w", "keep", "keep result"),
    ]
    name_of_command = "gap"

    def introduction(self) -> str:
        """Say what enter does."""
        if not self._available():
            return (
                "This armodal has no `armodal gap` command.\n"
                f"A result kept as {self.kept_path().name} beside the session, or given with "
                "--gap FILE, is shown here."
            )
        return (
            "enter: find where model and measurement disagree, and what the model lacks\n"
            f"(a result kept as {self.kept_path().name} beside the session is shown at once)"
        )

    def _available(self) -> bool:
        if self._command is not None:
            return True
        from tui.cli import app  # noqa: PLC0415  (the command line registers this screen)

        command = get_command(app)
        return "gap" in getattr(command, "commands", {})

    def result(self) -> RenderableType | None:
        """Verdict and all it stands on."""
        found = self.state.gap
        return None if found is None else gap_view(found)

    def kept_path(self) -> Path:
        """Where a result is kept."""
        return self.state.opened.path.with_suffix(".gap.json")

    def plan_path(self) -> Path:
        """Where the next test's plan goes."""
        path = self.state.opened.path
        return path.with_name(f"{path.stem}-next-test.toml")

    def action_start(self) -> None:
        """Start, where the command exists."""
        if self._available():
            super().action_start()
        else:
            self.app.bell()

    def action_plan(self) -> None:
        """Write the next test as a plan file; an existing one stays."""
        try:
            text = next_test_plan(self.state.opened.session, self.state.gap or {})
            write_plan(text, self.plan_path())
        except ArmodalError as error:
            self.app.notify(str(error), severity="error", timeout=10.0)
        else:
            self.app.notify(
                f"plan written: {self.plan_path()}; measure it with armodal run", timeout=10.0
            )

    def action_keep(self) -> None:
        """Write the result beside the session; an existing file stays."""
        if self.state.gap is None:
            self.app.notify("there is no result yet to keep", severity="warning")
            return
        try:
            with self.kept_path().open("x", encoding="utf-8") as file:
                file.write(json.dumps(self.state.gap, indent=2) + "\n")
        except FileExistsError:
            self.app.notify(
                f"{self.kept_path()} exists already; move it away first", severity="error"
            )
        except OSError as error:
            self.app.notify(f"{self.kept_path()}: {error.strerror}", severity="error")
        else:
            self.app.notify(f"kept: {self.kept_path()}")
