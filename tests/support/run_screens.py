"""The key screens of a session, by the events that lead to them; some are opened by a key."""

from __future__ import annotations

from support.made_run import (
    AT_HIT,
    AT_POINT,
    HIT_EVENTS,
    LAB_EVENTS,
    SESSION_EVENTS,
    judged,
    prompted,
    trial,
)
from support.stage import Stage
from textual.pilot import Pilot

from armodal.daq.events import Failed
from armodal.daq.session_machine import hit_judged
from armodal.tui.screens.run.happenings import SafeConfirmed, SensorsConfirmed

__all__ = ["SCREENS", "go_to"]

STOPPED = Failed(
    message="cannot write the journal: no space is left on the disk",
    kind="JournalError",
    journal="s.journal",
)
AFTER_A_HIT = (*HIT_EVENTS, judged(1), prompted(hit_judged(AT_HIT, accepted=True)))
SCREENS = {
    "lab-to-confirm": LAB_EVENTS,
    "lab": (*LAB_EVENTS, SensorsConfirmed(), *[trial()] * 4),
    "posture": SESSION_EVENTS,
    "approach": (*SESSION_EVENTS, prompted(AT_POINT)),
    "point": (*SESSION_EVENTS, prompted(AT_POINT), SafeConfirmed()),
    "move": (*SESSION_EVENTS, prompted(AT_POINT), SafeConfirmed()),
    "accepted": AFTER_A_HIT,
    "rejected": (*HIT_EVENTS, judged(1, "double")),
    "grid": AFTER_A_HIT,
    "stopped": (*AFTER_A_HIT, STOPPED),
}


OPENED_BY = {"grid": "g", "move": "m"}


async def go_to(stage: Stage, pilot: Pilot[int], name: str) -> None:
    """Bring the app to a screen, drawn to the end."""
    await stage.tell(pilot, *SCREENS[name])
    if name in OPENED_BY:
        await pilot.press(OPENED_BY[name])
    await stage.settle(pilot)
    await stage.settle(pilot)
