"""Points moved in a session are where they were measured when it is read back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal import Mark, MarkKind
from armodal.protocols.session.moved_points import MOVED, arm_with_moves, move_note, move_words

ARM = load_arm("rv4frl")


def note(text):
    return Mark(kind=MarkKind.NOTE, posture=None, point=None, host_s=1.0, note=text)


def test_the_last_of_a_points_moves_counts_and_its_axes_go_with_it():
    old = ARM.point("3")
    x, y, z = old.R_link_sensor.T
    turned = np.column_stack([y, -x, z])
    first = replace(old, position_m=old.position_m + 0.01)
    last = replace(
        old, position_m=old.position_m + np.array([0.0, 0.02, 0.0]), R_link_sensor=turned
    )
    marks = [note(move_note(first)), note("the tip was changed"), note(move_note(last))]
    moved = arm_with_moves(ARM, marks)
    # The arm file's digits: 10 um, and 1e-6 of an axis.
    np.testing.assert_allclose(moved.point("3").position_m, last.position_m, atol=5e-6)
    np.testing.assert_allclose(moved.point("3").R_link_sensor, turned, atol=2e-6)
    assert move_words(ARM, moved) == ("point 3 was moved by 20 mm before it was measured",)
    assert moved.sha256 != ARM.sha256
    assert arm_with_moves(ARM, [note("nothing")]) is ARM


@pytest.mark.parametrize("told", ["", "[]", '{"id": "99"}', '{"id": "3", "position_m": [1]}'])
def test_a_move_of_nothing_is_refused(told):
    with pytest.raises(JournalError, match="moves no point"):
        arm_with_moves(ARM, [note(MOVED + told)])
