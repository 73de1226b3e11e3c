"""A whole test in the simulated laboratory, watched."""

from __future__ import annotations

from armodal.tui.screens.home.choice import HomeChoice, HomeParts
from armodal.tui.screens.wishes import Demonstrate

__all__ = ["CHOICE"]

DEMO = "demo"  # its folder


def _chosen(parts: HomeParts) -> None:
    parts.app.exit(Demonstrate(folder=parts.folder / DEMO))


CHOICE = HomeChoice(
    key="d",
    label="demo",
    words="demo: watch a whole test in the simulated laboratory",
    place=30,
    measures=True,
    chosen=_chosen,
)
