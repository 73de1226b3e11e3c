"""The question whether the next test is measured now."""

from __future__ import annotations

from typing import Any, ClassVar

from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Static

from armodal.tui.screens.review.next_test import NextRun

__all__ = ["Measuring"]


class Measuring(ModalScreen[bool]):
    """Answers whether review is left for `armodal run`."""

    DEFAULT_CSS = """
    Measuring { align: center middle; }
    Measuring > Vertical { width: 72; max-width: 100%; height: auto; border: heavy $accent;
        padding: 1 2; background: $surface; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n,enter", "dismiss(True)", "measure it now"),
        Binding("escape", "dismiss(False)", "later"),
    ]

    def __init__(self, run: NextRun) -> None:
        super().__init__()
        self.run = run

    def compose(self) -> Any:
        """Ask."""
        plan, journal = self.run.plan.name, self.run.journal.name
        where = (
            "in the simulated laboratory, as this session was"
            if self.run.simulated
            else "in the laboratory: the first screen asks for the ports"
        )
        begun = "goes on with the session begun in" if self.run.journal.exists() else "goes into"
        with Vertical():
            yield Static(
                f"The next test is written: {plan}\n\n"
                f"n, enter  measure it now, {where};\n          it {begun} {journal}\n"
                "esc       later: the plan stays, and n asks again",
                markup=False,
            )
