"""A session in the simulated laboratory."""

from __future__ import annotations

from armodal.tui.screens.home.choice import HomeChoice, HomeParts
from armodal.tui.screens.home.found_sessions import new_journal
from armodal.tui.screens.home.new_session import NewSession

__all__ = ["CHOICE"]


def _chosen(parts: HomeParts) -> None:
    asks = NewSession(new_journal(parts.folder), simulated=True, arm=parts.arm_made)
    parts.app.push_screen(asks, parts.leave_with)


CHOICE = HomeChoice(
    key="s",
    label="try it simulated",
    words="try it: hit a simulated arm yourself",
    place=20,
    measures=True,
    chosen=_chosen,
)
