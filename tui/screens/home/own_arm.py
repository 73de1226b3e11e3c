"""Which robot description an arm file is made of."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from armodal.tui.screens.wishes import OwnArm

__all__ = ["DescriptionOfArm"]

_DESCRIPTIONS = (".urdf", ".xacro", ".xml")


class DescriptionOfArm(ModalScreen[OwnArm | None]):
    """Asks for one file; the rest is asked where the arm is made."""

    DEFAULT_CSS = """
    DescriptionOfArm { align: center middle; }
    DescriptionOfArm > Vertical { width: 76; max-width: 100%; height: auto; border: heavy $accent;
        padding: 0 1; background: $surface; }
    DescriptionOfArm Input, DescriptionOfArm Input:focus { height: 1; border: none; padding: 0;
        margin: 1 0; background: $boost; }
    DescriptionOfArm #wrong { color: $error; }
    """
    AUTO_FOCUS = "Input"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "back")]

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder

    def compose(self) -> ComposeResult:
        """Ask."""
        with Vertical():
            yield Static(
                "Robot description of your arm: a .urdf, .xacro or .xml (MJCF) file. Enter makes "
                "its arm file, test points and plan in a folder of their own; mass and mounting "
                "are asked first.   (escape: back)",
                markup=False,
            )
            yield Input(placeholder="path of the file")
            yield Static("", id="wrong", markup=False)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Leave with the file if it is one."""
        described = Path(event.value.strip()).expanduser()
        path = self._folder / described
        if path.suffix.lower() not in _DESCRIPTIONS or not path.is_file():
            self.query_one("#wrong", Static).update(
                f"wanted a {', '.join(_DESCRIPTIONS)} file that is there, got {described}"
            )
            return
        self.dismiss(OwnArm(description=path, folder=self._folder))
