"""Identify and Gap as the engineer sees them, character by character."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.screen_snapshot import assert_as_kept
from support.shown_results import GAP, IDENTIFIED

KEPT = Path(__file__).parent / "snapshots"
NEXT = {"words": "Hit point 7 along y.", "why": "It tells two rivals apart.", "gain": 12.5}


@pytest.mark.parametrize("size", [(80, 24), pytest.param((160, 45), marks=pytest.mark.long)])
@pytest.mark.parametrize("name", [pytest.param("identify", marks=pytest.mark.long), "gap"])
def test_the_screen_is_as_kept(drive, name, size):
    async def steps(app, pilot):
        app.state.identification = IDENTIFIED
        app.state.gap = {**GAP, "next_test": {**NEXT, "plan_toml": "format = 1"}}
        app.redraw()
        await pilot.press("7" if name == "identify" else "8")
        await pilot.pause(0.4)  # the tabs' underline has arrived
        assert_as_kept(app, KEPT / f"{name}-{size[0]}x{size[1]}.txt")

    drive(steps, size=size)
