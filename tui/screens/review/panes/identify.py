"""Identify: stiffness with ranges, the method beside it."""

from __future__ import annotations

from typing import Any

from rich.console import RenderableType

from armodal.tui.screens.review.identify_text import identification_view
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.picked_file import picked_path
from armodal.tui.screens.review.run_pane import RunPane

__all__ = ["PANE", "IdentifyPane"]


class IdentifyPane(RunPane):
    """Runs `armodal identify` beside the app."""

    HELP = """# Identify
`enter` identifies joint stiffness, damping and structural axes from all postures of the session,
in a process of its own; `escape` stops it. The model is fitted to the FRFs. Where poles were picked
by hand and saved, they take the place of the automatic modes: these say where the fit starts, how
far up it goes, and what is set beside the result.
"""
    name_of_command = "identify"

    def arguments(self) -> tuple[str, ...]:
        """With the band looked at, and the poles picked by hand, where there are any."""
        arguments = super().arguments()
        if self.state.opened.band_hz is not None:
            arguments += ("--band", *map(str, self.state.opened.band_hz))
        if not self._by_hand():
            return arguments
        return (*arguments, "--picked", str(picked_path(self.state.opened.path)))

    def introduction(self) -> str:
        """Say what enter does, and of which modes."""
        by_hand = self._by_hand()
        others = len(self.state.views) - len(by_hand)
        modes = "the automatic modes of all postures"
        if by_hand:
            modes = f"poles picked by hand in {', '.join(by_hand)}"
            modes += f", the automatic modes of {others} more" if others else ""
        return (
            "enter: identify joint stiffness, damping and structural axes\n"
            f"from the FRFs of {len(self.state.views)} postures, beginning with {modes}"
        )

    def action_start(self) -> None:
        """Start; what is on the screen but not in the file is said first."""
        if any(view.changed for view in self.state.views):
            self.app.notify("refit the picks first (3, then r)", severity="warning")
        elif self.state.unsaved:
            self.app.notify("save the picks first (s), then press enter", severity="warning")
        else:
            super().action_start()

    def keep(self, value: dict[str, Any]) -> None:
        """Keep it for all screens."""
        self.state.identification = value

    def result(self) -> RenderableType | None:
        """Tables with ranges."""
        found = self.state.identification
        return None if found is None else identification_view(found)

    def _by_hand(self) -> list[str]:
        return [view.name for view in self.state.views if view.by_hand]


PANE = ReviewPane(
    title="Identify",
    place=7,
    make=lambda parts: (IdentifyPane(parts.state, command=parts.command),),
)
