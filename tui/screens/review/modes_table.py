"""The modes of a posture as a table, with what is not sure about them."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.reactive import var
from textual.widgets import DataTable

from armodal.tui.deviation import deviation
from armodal.tui.screens.review.state import ReviewState

__all__ = ["ModesTable"]

_COLUMNS = (
    "f Hz", "± std", "damp %", "± std", "MPC", "MPD °", "joints %", "kind", "chosen",
    "seen %", "weight",
)  # fmt: skip


# What goes first where there is little room: what a reader asks for last.
_GIVE_WAY = ("MPD °", "weight", "MPC", "seen %", "chosen")


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
                deviation(mode.f_std_hz),
                f"{100 * mode.damping_ratio:.2f}",
                deviation(100 * mode.damping_std),
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


def kept_columns(rows: list[tuple[str, ...]], room: int, padding: int) -> tuple[int, ...]:
    """Numbers of the columns that fit, as `_GIVE_WAY` has it; what is left may be scrolled."""
    wide = [
        max(map(len, column)) + 2 * padding
        for column in zip(_COLUMNS, *rows, strict=True)  # a column is its heading and its cells
    ]
    kept = list(range(len(_COLUMNS)))
    for name in _GIVE_WAY:
        if sum(wide[i] for i in kept) <= room:
            break
        kept.remove(_COLUMNS.index(name))
    return tuple(kept)


class ModesTable(DataTable[str]):
    """One row a mode; the cursor chooses the mode for all screens."""

    HELP = """# Modes
Frequency and damping with one standard deviation; MPC is 1 and MPD 0 for a real mode, whose points
all move in phase or in antiphase. `joints %` is the share of the motion that turning joints
explains: below 90 % the mode is called structural. `seen` is the share of model orders with this
pole, `weight` how much worse the fit is without the mode, over what noise alone would give. Below
stand modes that move from point to point, and peaks that no mode explains. `enter` shows the
shape.
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "app.tab('shape')", "shape"),
        Binding("s", "app.save", "save picks"),
    ]

    left_out: var[tuple[str, ...]] = var(())
    """Columns for which there is no room; who tells of them watches it."""

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, cursor_type="row", zebra_stripes=True)
        self.state = state

    def on_mount(self) -> None:
        """Fill the table."""
        self.redraw()

    def on_resize(self) -> None:
        """Show what fits."""
        self.redraw()

    def redraw(self) -> None:
        """Fill the table anew."""
        if not self.is_mounted:
            return
        chosen, rows = self.state.mode, mode_rows(self.state)
        kept = kept_columns(rows, self.size.width, self.cell_padding)
        self.left_out = tuple(name for i, name in enumerate(_COLUMNS) if i not in kept)
        self.clear(columns=True)
        for number in kept:
            self.add_column(_COLUMNS[number], key=f"{number}")
        for row in rows:
            self.add_row(*(row[number] for number in kept))
        if self.row_count:
            self.move_cursor(row=min(chosen, self.row_count - 1))

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Look at the mode under the cursor."""
        if self.has_focus:
            self.state.choose_mode(event.cursor_row)
