"""The devices that the operating system knows of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

__all__ = ["Devices"]


class Devices(ModalScreen[None]):
    """Serial ports with what their devices call themselves, and how to check them."""

    DEFAULT_CSS = """
    Devices { align: center middle; }
    Devices > VerticalScroll { width: 76; max-width: 100%; height: auto; max-height: 100%;
        border: heavy $accent; padding: 1 2; background: $surface; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape,q,enter", "dismiss(None)", "back")]

    def __init__(self, ports: Sequence[tuple[str, str]]) -> None:
        super().__init__()
        self._ports = ports

    def compose(self) -> ComposeResult:
        """One port a line."""
        said = "\n".join(f"{path}  {description}" for path, description in self._ports)
        with VerticalScroll():
            yield Static(
                f"{said or 'No serial device is plugged in.'}\n\n"
                "Board:  armodal check board PORT\n"
                "Robot:  armodal check can PORT   (only listens)\n\n"
                "Both ask the device for all that a test needs of it. Esc goes back.",
                markup=False,
            )
