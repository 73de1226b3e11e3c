"""The key screens of a session as the operator sees them, character by character."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.run_screens import SCREENS, go_to
from support.screen import screen_rows
from support.screen_snapshot import assert_as_kept
from support.stage import Stage, play

KEPT = Path(__file__).parent / "snapshots"
KEYS = {
    "lab-to-confirm": "⏎ Go on c Mass b Bell ? Help q Leave",
    "lab": "⏎ Go on a Trigger c Mass b Bell ? Help q Leave",
    "posture": "t Retake k Skip g Grid b Bell ? Help q Leave",
    "approach": "⏎ Go on m Move t Retake k Skip g Grid b Bell ? Help q Leave",
    "point": "←→ Turn ⏎ Go on m Move t Retake k Skip g Grid b Bell ? Help q Leave",
    "move": "←→ Turn b Bell ? Help q Leave",
    "accepted": "t Retake k Skip u Undo g Grid b Bell ? Help q Leave",
    "rejected": "t Retake k Skip g Grid b Bell ? Help q Leave",
    "grid": "←→ Choose ⏎ Go on u Undo g Grid b Bell ? Help q Leave",
    "stopped": "←→ Choose r Try again b Bell ? Help q Leave",
}
QUICK = {"lab-to-confirm", "lab", "point", "rejected", "stopped"}


@pytest.mark.parametrize("size", [(80, 24), pytest.param((160, 45), marks=pytest.mark.long)])
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name in QUICK else pytest.mark.long) for name in SCREENS],
)
def test_the_screen_is_as_kept_above_the_keys_in_use(tmp_path, monkeypatch, name, size):
    monkeypatch.delenv("NO_COLOR", raising=False)
    stage = Stage(tmp_path)

    async def body(pilot):
        await go_to(stage, pilot, name)
        assert_as_kept(stage.app, KEPT / f"{name}-{size[0]}x{size[1]}.txt")
        assert screen_rows(stage.app)[-1] == KEYS[name]

    play(stage, body, size)
