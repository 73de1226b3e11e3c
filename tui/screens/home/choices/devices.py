"""What is plugged in."""

from __future__ import annotations

from armodal.tui.screens.home.choice import HomeChoice, HomeParts
from armodal.tui.screens.home.devices import Devices

__all__ = ["CHOICE"]


def _chosen(parts: HomeParts) -> None:
    parts.app.push_screen(Devices(parts.ports()))


CHOICE = HomeChoice(
    key="v",
    label="devices",
    words="devices: what is plugged in",
    place=40,
    measures=True,
    chosen=_chosen,
)
