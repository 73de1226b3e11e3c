"""A test in real time is repeated for a stall that was measured, and for nothing else."""

import sys
import time

import pytest
from support.held_up import StallWatch

HELD_S, DEADLINE_S = 0.15, 60.0


@pytest.fixture
def nobody_else_runs():
    switched_s = sys.getswitchinterval()
    sys.setswitchinterval(2.0 * HELD_S)
    yield
    sys.setswitchinterval(switched_s)


def test_a_stall_is_noted_with_its_length_and_forgotten_after(nobody_else_runs):
    watch = StallWatch()
    began_s = time.monotonic()
    while watch.longest_s(began_s) == 0.0 and time.monotonic() - began_s < DEADLINE_S:
        time.sleep(0.01)  # its threads nap
        held_from_s = time.monotonic()
        while time.monotonic() - held_from_s < HELD_S:
            pass
        time.sleep(0.01)  # and note
    assert watch.longest_s(began_s) > 0.5 * HELD_S
    assert watch.longest_s(time.monotonic() + DEADLINE_S) == 0.0
