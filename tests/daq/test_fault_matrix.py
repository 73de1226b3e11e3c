"""A few of the seeded runs of `bench/torture_faults.py`, and those that once showed a fault."""

from functools import partial

import pytest
from support.fault_runs import MATRIX, run_seed, script_of
from support.virtual_lab import VirtualLab

from armodal.daq.events import Failed, Finished
from armodal.protocols.session.journal import decode_journal

QUICK = {24, 27, 35, 36, 37, 39, 41, 43}  # those that no other of them is like


def words_of(outcome):
    last = outcome.endings[-1]
    return last.reason if isinstance(last, Finished) else last.message


def test_a_session_without_faults_loses_nothing():
    outcome = run_seed(0, script=((), ()))
    assert outcome.violations == []
    assert outcome.counts["accepted"] == 4
    assert outcome.counts["missing preview samples"] == 0
    assert isinstance(outcome.endings[-1], Finished)


@pytest.mark.long
def test_the_same_seed_is_the_same_run():
    one, other = (decode_journal(run_seed(9).journal) for _ in range(2))
    assert [h.trigger_host_s for h in one.hits] == [h.trigger_host_s for h in other.hits]
    assert one.losses == other.losses


def seeds():
    """One run of every kind of fault, two at once, around a blow and at any sample."""
    for seed in range(len(MATRIX), 2 * len(MATRIX)):
        yield pytest.param(seed, marks=() if seed in QUICK else pytest.mark.long)


@pytest.mark.parametrize("seed", [*seeds()])
def test_the_invariant_holds(seed):
    outcome = run_seed(seed, make_lab=partial(VirtualLab, step_s=0.01))
    assert outcome.violations == [], (script_of(seed), words_of(outcome))


def test_an_arm_that_moves_during_a_hit_and_comes_back_is_noticed():
    outcome = run_seed(3, script=((), ((2, "arm-twitches", 20, 0),)))
    assert outcome.violations == []
    assert outcome.counts["moved"] == 1
    assert outcome.counts["accepted"] == 4


def test_an_arm_that_moves_while_the_bus_is_silent_during_a_hit_is_noticed():
    at_blow = ((2, "can-silence", 66, 492), (2, "arm-twitches", 66, 0))
    outcome = run_seed(436, script=((), at_blow))
    assert outcome.violations == []
    assert outcome.counts["stale"] == 1


def test_a_silence_that_began_before_the_hit_hides_no_motion_in_it():
    script = (("can-silence@3472+218", "arm-twitches@3472"), ())
    outcome = run_seed(134, script=script)
    assert outcome.violations == []
    assert outcome.counts["stale"] == 1


@pytest.mark.parametrize(
    "after", [8, *(pytest.param(at, marks=pytest.mark.long) for at in (-30, 120))]
)
def test_a_hit_is_not_used_whose_time_is_lost_to_a_jump_of_the_board_s_clock(after):
    outcome = run_seed(12, script=((), ((2, "clock-jump", after, 0),)))
    assert outcome.violations == []
    assert outcome.counts["accepted"] == 4


def test_what_was_lost_is_kept_though_the_session_fails_a_moment_later():
    script = (("frame-drop@2500+200", "board-reboot@2700"), ())
    outcome = run_seed(4, script=script)
    assert outcome.violations == []
    assert outcome.counts["missing preview samples"] > 0
    assert isinstance(outcome.endings[0], Failed)
    assert "restarted" in outcome.endings[0].message
    assert b"interrupted: the board on board has restarted" in outcome.journal


def test_noise_of_a_broken_hammer_cable_is_no_hit():
    outcome = run_seed(83, script=((), ((1, "channel-garbage", 223, 30),)))
    assert outcome.violations == []


def test_triggers_the_board_missed_to_the_last_are_reported():
    # The line takes nothing while the last hits are made: three blocks fill the board.
    outcome = run_seed(5, script=((), ((1, "device-overflow", 400, 6000),)))
    assert outcome.violations == []
