"""The question before leaving with picks that are not saved."""

from __future__ import annotations

from typing import Any, ClassVar

from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Static

__all__ = ["Leaving"]


class Leaving(ModalScreen[str]):
    """Answers "save", "leave" or "stay"."""

    DEFAULT_CSS = """
    Leaving { align: center middle; }
    Leaving > Vertical { width: 60; height: auto; border: heavy $warning; padding: 1 2;
        background: $surface; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("s", "dismiss('save')", "save and leave"),
        Binding("q", "dismiss('leave')", "leave without"),
        Binding("escape", "dismiss('stay')", "stay"),
    ]

    def __init__(self, path: str) -> None:
        super().__init__()
        self.path = path

    def compose(self) -> Any:
        """Ask."""
        with Vertical():
            yield Static(
                f"The picked poles are not saved.\n\ns  save them as {self.path}, and leave\n"
                "q  leave without saving\nesc  stay",
                markup=False,
            )
