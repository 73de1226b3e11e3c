"""The modes of a posture as a table, with what is not sure about them."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widgets import DataTable

from armodal.tui.screens.review.state import ReviewState

__all__ = ["ModesTable"]

_COLUMNS = (
    "f Hz", "± std", "damp %", "± std", "MPC", "MPD °", "joints %", "kind", "chosen",
    "seen %", "weight",
)  # fmt: skip


def mode_rows(state: ReviewState) -> list[tuple[str, ...]]:
    """Rows of the posture looked at; an unknown share is said so."""
    view = state.view
    if view.model is None:
        return []
    rows: list[tuple[str, ...]] = []
    for number, mode in enumerate(view.model.modes):
        share = view.joint_share[number]
        kind = "-" if share is None else "structural" if view.structural(number) else "joints"
        rows.append(
            (
                f"{mode.f_hz:.3f}",
                f"{mode.f_std_hz:.3f}",
                f"{100 * mode.damping_ratio:.2f}",
                f"{100 * mode.damping_std:.3f}",
                f"{mode.mpc:.3f}",
                f"{mode.mpd_deg:.1f}",
                "unknown" if share is None else f"{100 * share:.0f}",
                kind,
                "by hand" if view.by_hand else "automatic",
                f"{100 * mode.stability:.0f}",
                f"{mode.significance:.3g}",
            )
        )
    return rows


class ModesTable(DataTable[str]):
    """One row a mode; the cursor chooses the mode for all screens."""

    HELP = """# Modes
Frequency and damping with one standard deviation; MPC is 1 and MPD 0 for a shape whose points all
move in phase. `joints %` is the share of the motion that turning joints explains: below 90 % the
mode is called structural. `seen` is the share of model orders with this pole, `weight` how much
worse the fit is without the mode, over what noise alone would give. Below stand modes that move
from point to point, and peaks that no mode explains. `enter` shows the shape.
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "app.tab('shape')", "shape"),
        Binding("s", "app.save", "save picks"),
    ]

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, cursor_type="row", zebra_stripes=True)
        self.state = state

    def on_mount(self) -> None:
        """Name the columns."""
        for number, name in enumerate(_COLUMNS):
            self.add_column(name, key=f"{number}")
        self.redraw()

    def redraw(self) -> None:
        """Fill the table anew."""
        if not self.columns:
            return
        chosen = self.state.mode
        self.clear()
        for row in mode_rows(self.state):
            self.add_row(*row)
        if self.row_count:
            self.move_cursor(row=min(chosen, self.row_count - 1))

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Look at the mode under the cursor."""
        if self.has_focus:
            self.state.choose_mode(event.cursor_row)
