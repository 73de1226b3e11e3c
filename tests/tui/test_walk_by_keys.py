"""From `armodal` to a report by keys alone, in a real terminal of 80 x 24."""

from __future__ import annotations

import json
import shutil

import pytest
from support.walk import WALKED_POINTS, home_in, small_plan, walk_to_the_report

from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.session.hdf5 import read_session

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(shutil.which("tmux") is None, reason="needs tmux"),
]
POSTURES, HITS = 4, 2


def test_an_own_arm_is_made_from_home_and_offered_for_the_next_session(tmp_path):
    shutil.copyfile(ARMS_DIRECTORY / "rv4frl.urdf", tmp_path / "mine.urdf")
    with home_in(tmp_path) as terminal:
        terminal.until("own arm", 60.0)
        terminal.keys("o")
        terminal.until("Robot description of your arm", 60.0)
        terminal.keys(*"mine.urdf", "Enter")
        for asked in ("last link of the arm", "mass of the arm", "mounting"):
            terminal.until(asked, 60.0)
            terminal.keys("Enter")
        terminal.until("back to the home screen", 300.0)
        terminal.keys("Enter")
        terminal.until("arm file mine/mine.toml", 60.0)
        terminal.keys("n")
        terminal.until(r"Arm +mine/mine.toml", 60.0, r"Plan +mine/plan.toml")
    assert load_arm(tmp_path / "mine" / "mine.toml").name == "mine"


def test_a_session_is_measured_reviewed_explained_and_reported_without_leaving(tmp_path):
    small_plan(tmp_path / "small.toml", postures=POSTURES, hits=HITS)
    with home_in(tmp_path) as terminal:
        walk_to_the_report(terminal, "small.toml")
    session = read_session(tmp_path / "session.h5")
    assert session.complete
    assert len(session.accepted()) == POSTURES * len(WALKED_POINTS) * HITS
    found = json.loads((tmp_path / "session.gap.json").read_text(encoding="utf-8"))
    report = (tmp_path / "session.html").read_text(encoding="utf-8")
    assert found["summary"] in report
    assert "What to do next" in report
