"""What a fit has to say beside its table: modes that move, peaks that no mode explains."""

from __future__ import annotations

from textual.widgets import Static

from armodal.analyzer.modal import drift_told
from armodal.protocols.session.operator_angles import angles_by_hand
from armodal.tui.screens.review.modes_table import ModesTable
from armodal.tui.screens.review.state import ReviewState

__all__ = ["ModelNotes", "model_notes"]


def model_notes(state: ReviewState) -> tuple[str, ...]:
    """Sentences about the posture looked at; none where there is nothing to say."""
    model = state.view.model
    if model is None:
        return ()
    told = angles_by_hand(state.opened.session.header)
    moves = (f"moves: {told.words}" for told in drift_told(model))
    return (*state.view.said, *told, *moves, *model.notes)


class ModelNotes(Static):
    """Lines under the table of modes; out of sight where there are none."""

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__("", id=id, markup=False)
        self.state = state

    def on_mount(self) -> None:
        """Say what is known, and what has no room as soon as the table knows."""
        for table in self.screen.query(ModesTable):
            self.watch(table, "left_out", self.redraw, init=False)
        self.redraw()

    def redraw(self) -> None:
        """Say it anew."""
        hidden = [name for table in self.screen.query(ModesTable) for name in table.left_out]
        notes = model_notes(self.state)
        if hidden:
            notes = (f"in a wider window: {', '.join(hidden)}", *notes)
        self.display = bool(notes)
        self.update("\n".join(notes))
