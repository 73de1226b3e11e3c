"""Identify: stiffness with ranges, the method beside it."""

from __future__ import annotations

from rich.console import RenderableType

from tui.review.identify_text import identification_view
from tui.review.run_pane import RunPane

__all__ = ["IdentifyPane"]


class IdentifyPane(RunPane):
    """Runs `armodal identify` beside the app."""

    HELP = """# Identify
`enter` identifies joint stiffness, damping and structural axes from all postures of the session,
in a process of its own; `escape` stops it. It uses the automatic modes of `armodal identify`, not
the poles picked here.
"""
    name_of_command = "identify"

    def introduction(self) -> str:
        """Say what enter does."""
        return (
            "enter: identify joint stiffness, damping and structural axes\n"
            "(all postures; the automatic modes, not the poles picked by hand)"
        )

    def result(self) -> RenderableType | None:
        """Tables with ranges."""
        found = self.state.identification
        return None if found is None else identification_view(found)
