"""The key screens of a session as the operator sees them, character by character."""

from __future__ import annotations

from pathlib import Path

import pytest
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
from support.screen_snapshot import assert_as_kept
from support.stage import Stage, play

from armodal.daq.events import Failed
from armodal.daq.session_machine import hit_judged
from armodal.tui.screens.run.happenings import SafeConfirmed, SensorsConfirmed

KEPT = Path(__file__).parent / "snapshots"
STOPPED = Failed(
    message="cannot write the journal: No space left on device",
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
    "accepted": AFTER_A_HIT,
    "rejected": (*HIT_EVENTS, judged(1, "double")),
    "grid": AFTER_A_HIT,
    "stopped": (*AFTER_A_HIT, STOPPED),
}


@pytest.mark.parametrize("size", [(80, 24), (160, 45)])
@pytest.mark.parametrize("name", SCREENS)
def test_the_screen_is_as_kept(tmp_path, monkeypatch, name, size):
    monkeypatch.delenv("NO_COLOR", raising=False)
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *SCREENS[name])
        if name == "grid":
            await pilot.press("g")
        await stage.settle(pilot)
        await stage.settle(pilot)
        assert_as_kept(stage.app, KEPT / f"{name}-{size[0]}x{size[1]}.txt")

    play(stage, body, size)
