from __future__ import annotations

import multiprocessing
import threading
import time

import pytest

from armodal.daq.commands import Stop, TriggerLevel
from armodal.daq.events import BoardFound, DeviceTrouble, Finished, Health, JointsSeen, TrialHit
from armodal.daq.lab_watch import run_lab_watch
from armodal.daq.settings import AcquisitionSettings


class Watch:
    """A watch in a thread, and the listener's end of the line."""

    def __init__(self, lab, **changes) -> None:
        settings = AcquisitionSettings(
            board_port=changes.get("board_port", lab.board.name),
            can_channel=changes.get("can_channel", lab.controller.name),
            arm=lab.arm,
            plan=lab.plan,
            journal=lab.journal,
        )
        self.ours, theirs = multiprocessing.Pipe()
        self.thread = threading.Thread(target=run_lab_watch, args=(settings, theirs))
        self.thread.start()

    def until(self, kind, wanted=lambda event: True, timeout_s: float = 60.0):
        end_s = time.monotonic() + timeout_s
        while self.ours.poll(max(end_s - time.monotonic(), 0.0)):
            event = self.ours.recv()
            if isinstance(event, kind) and wanted(event):
                return event
        return pytest.fail(f"no {kind.__name__} came")

    def end(self) -> None:
        self.ours.send(Stop())
        self.thread.join(10.0)
        assert not self.thread.is_alive()


@pytest.fixture
def watch(lab):
    watches = []

    def start(**changes):
        watches.append(Watch(lab, **changes))
        return watches[-1]

    yield start
    for one in watches:
        one.end()


def test_board_and_controller_are_found_and_told_of(lab, watch):
    one = watch()
    assert one.until(BoardFound).port == lab.board.name
    seen = one.until(JointsSeen, lambda e: e.reading.joints_rad is not None)
    assert seen.reading.held
    health = one.until(Health, lambda e: e.clock_uncertainty_s is not None and e.can_frames > 0)
    assert health.clock_uncertainty_s > 0.0
    assert not lab.journal.exists()


def test_a_trial_hit_is_judged_and_released_and_kept_nowhere(lab, watch, fakes):
    one = watch()
    one.until(BoardFound)
    block = lab.board.hit(fakes["record"]())
    trial = one.until(TrialHit)
    assert trial.verdict.peak_n == pytest.approx(200.0, rel=0.05)  # the sampled half sine's peak
    deadline_s = time.monotonic() + 60.0
    while block not in lab.board.released and time.monotonic() < deadline_s:
        time.sleep(0.01)
    assert lab.board.released == [block]
    assert not lab.journal.exists()


def test_another_trigger_level_reaches_the_board(lab, watch):
    one = watch()
    one.until(BoardFound)
    before = lab.board.configuration.trigger_level_counts
    one.ours.send(TriggerLevel(level_n=16.0))
    one.until(BoardFound)
    assert lab.board.configuration.trigger_level_counts == 2 * before


def test_a_board_that_is_not_there_is_said_and_the_controller_still_watched(lab, watch):
    one = watch(board_port="/dev/there-is-no-such-port")
    trouble = one.until(DeviceTrouble, lambda e: e.device == "board")
    assert "there is no such device" in trouble.message
    one.until(JointsSeen, lambda e: e.reading.joints_rad is not None)


def test_a_silent_controller_leaves_the_angles_unknown(lab, watch):
    lab.controller.silent = True
    one = watch()
    one.until(BoardFound)
    assert one.until(JointsSeen).reading.joints_rad is None


def test_a_listener_that_goes_ends_the_watch(lab):
    one = Watch(lab)
    one.until(BoardFound)
    one.ours.close()
    one.thread.join(10.0)
    assert not one.thread.is_alive()


def test_the_end_is_told(lab):
    one = Watch(lab)
    one.until(BoardFound)
    one.ours.send(Stop(reason="enough"))
    assert one.until(Finished).reason == "enough"
    one.thread.join(10.0)
