from __future__ import annotations

import math

import numpy as np
import pytest

from armodal.daq.judge_posture import judge_posture
from armodal.protocols.session.records import JointReading

PLANNED = np.radians([10.0, 20.0, 30.0])
TOLERANCE = math.radians(0.5)
MOVED = math.radians(0.1)


def reading(offset_deg: float = 0.0, **changes: object) -> JointReading:
    values: dict[str, object] = {
        "joints_rad": PLANNED + np.radians(offset_deg),
        "drive_state": 2,
        "held": True,
        "age_s": 0.004,
        "host_s": 1.0,
    }
    return JointReading(**(values | changes))


@pytest.mark.parametrize(
    ("before", "after", "reasons"),
    [
        (reading(), reading(), ()),
        (reading(0.45), reading(0.45), ()),
        (reading(0.6), reading(0.6), ("posture",)),
        (reading(0.0), reading(0.2), ("moved",)),
        (reading(0.0), reading(3.0), ("posture", "moved")),
        (reading(), reading(joints_rad=None, age_s=2.0), ("stale",)),
        (reading(joints_rad=None, age_s=math.inf), reading(), ("absent",)),
        (reading(held=False), reading(held=False), ("not-held",)),
    ],
)
def test_each_way_to_stand_wrong_has_its_reason(before, after, reasons):
    found, notes = judge_posture(before, after, PLANNED, TOLERANCE, MOVED)
    assert found == reasons
    assert bool(notes) == bool(reasons)


def test_a_move_that_ends_where_it_began_is_a_move():
    found, notes = judge_posture(reading(), reading(), PLANNED, TOLERANCE, MOVED, 1.5 * MOVED)
    assert found == ("moved",)
    assert len(notes) == 1


def test_a_hit_during_which_nothing_was_known_is_stale():
    said = "no joint angles for 0.3 s during the hit"
    found, notes = judge_posture(reading(), reading(), PLANNED, TOLERANCE, MOVED, 0.0, said)
    assert (found, notes) == (("stale",), (said,))
