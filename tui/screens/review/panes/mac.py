"""The MAC matrix as numbers on shades."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import numpy.typing as npt
from textual.binding import Binding, BindingType

from armodal.analyzer.modal import ModalModel, mac_matrix
from armodal.tui.drawing import Canvas
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.picture import Picture
from armodal.tui.screens.review.state import ReviewState

__all__ = ["PANE", "MacPicture"]

_SHADES = " ░▒▓█"
_CELL, _HEAD = 8, 9


class MacPicture(Picture):
    """Likeness of the modes of a posture, among themselves or with another set."""

    HELP = """# MAC
How alike the shapes of two modes are: 1 the same shape, 0 nothing in common. Off the diagonal a
high value means two modes the points cannot tell apart, or one mode found twice. `c` compares with
the automatic choice or with another posture measured at the same points (along the sensor's axes,
which move with the arm).
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("c", "compare", "compare with"),
        Binding("up", "move(0, -1)", "move", show=False),
        Binding("down", "move(0, 1)", "move", show=False),
        Binding("left", "move(-1, 0)", "move", show=False),
        Binding("right", "move(1, 0)", "move", show=False),
    ]

    def __init__(self, state: ReviewState, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(state, id=id)
        self.other = 0
        self.corner = (0, 0)

    def partners(self) -> list[tuple[str, ModalModel]]:
        """Return the sets of modes the posture's own can be compared with."""
        view = self.state.view
        if view.model is None or not view.model.modes:
            return []
        found = [(view.name, view.model)]
        if view.by_hand and view.automatic is not None and view.automatic.modes:
            found.append((f"{view.name}, automatic", view.automatic))
        wanted = _dofs(view.model)
        found += [
            (other.name, other.model)
            for other in self.state.views
            if other.name != view.name
            and other.model is not None
            and other.model.modes
            and _dofs(other.model) == wanted
        ]
        return found

    def action_compare(self) -> None:
        """Compare with the next set."""
        self.other += 1
        self.corner = (0, 0)
        self.redraw()

    def action_move(self, across: int, down: int) -> None:
        """Show other rows and columns of a matrix larger than the screen."""
        self.corner = (max(self.corner[0] + across, 0), max(self.corner[1] + down, 0))
        self.redraw()

    def paint(self, columns: int, rows: int) -> Canvas:
        """Numbers in shaded cells, frequencies at the sides."""
        canvas = Canvas(columns, rows)
        partners, own = self.partners(), self.state.model
        if not partners or own is None:
            canvas.label(0, 0, self.state.view.problem or "no modes to compare", "bold")
            return canvas
        name, other = partners[self.other % len(partners)]
        values = mac_matrix(_shapes(own), _shapes(other))
        canvas.label(0, 0, f"MAC of {self.state.view.name} (down) with {name} (across)", "bold")
        tall = 2 if rows >= 3 + 2 * len(own.modes) else 1
        wide, high = max((columns - _HEAD) // _CELL, 1), max((rows - 2) // tall, 1)
        x0 = min(self.corner[0], max(values.shape[1] - wide, 0))
        y0 = min(self.corner[1], max(values.shape[0] - high, 0))
        self.corner = (x0, y0)
        for column, mode in enumerate(other.modes[x0 : x0 + wide]):
            canvas.label(_HEAD + column * _CELL, 1, f"{mode.f_hz:7.2f}", self.inks.plain)
        for row, mode in enumerate(own.modes[y0 : y0 + high]):
            canvas.label(0, 2 + row * tall, f"{mode.f_hz:7.2f}", self.inks.plain)
            for column in range(min(wide, values.shape[1] - x0)):
                self._cell(canvas, (column, row), tall, float(values[y0 + row, x0 + column]))
        return canvas

    def _cell(self, canvas: Canvas, at: tuple[int, int], tall: int, value: float) -> None:
        shade = _SHADES[min(int(value * len(_SHADES)), len(_SHADES) - 1)]
        column, row = _HEAD + at[0] * _CELL, 2 + at[1] * tall
        style = self.inks.strong if value >= 0.8 else self.inks.plain
        canvas.label(column, row, f"{shade}{value:5.2f}{shade}", style)
        for below in range(1, tall):
            canvas.label(column, row + below, shade * (_CELL - 1), style)


def _dofs(model: ModalModel) -> tuple[tuple[str, str], ...]:
    dofs = model.responses if len(model.responses) >= len(model.references) else model.references
    return tuple((dof.point, dof.label) for dof in dofs)


def _shapes(model: ModalModel) -> npt.NDArray[np.complex128]:
    """Shapes (n_dofs, n_modes) on the side that has the points."""
    by_response = len(model.responses) >= len(model.references)
    return np.stack(
        [mode.shape if by_response else mode.participation for mode in model.modes], axis=1
    )


PANE = ReviewPane(title="MAC", place=5, make=lambda parts: (MacPicture(parts.state),))
