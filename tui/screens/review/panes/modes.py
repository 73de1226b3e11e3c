"""Modes: their table, and what the fit has to say beside it."""

from __future__ import annotations

from armodal.tui.screens.review.model_notes import ModelNotes
from armodal.tui.screens.review.modes_table import ModesTable
from armodal.tui.screens.review.pane import ReviewPane

__all__ = ["PANE"]

PANE = ReviewPane(
    title="Modes",
    place=4,
    make=lambda parts: (ModesTable(parts.state), ModelNotes(parts.state)),
)
