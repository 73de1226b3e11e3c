"""A healthy bus passes; each broken one is caught by its step. Time here moves only when told."""

import re
from dataclasses import replace

import pytest
from support.quick import every_but

from armodal.daq.check import CAN_STEPS, CheckError, Verdict, check_can
from armodal.daq.check import can as can_check
from armodal.hil_sim.broken_controller import (
    BROKEN_CONTROLLERS,
    BrokenController,
    broken_controller,
)
from armodal.protocols.can_database import CanEncoder
from armodal.protocols.errors import ArmError, CanError, PlantError
from armodal.protocols.slcan import CanFrame, SlcanParser, SlcanReply, encode_slcan

HELD, MOVING = 2, 3
DURATION_S = 4.0

CAUGHT = {
    "alone": ("acknowledged", "in a row: .* for want of an acknowledge, .* error-passive"),
    "bursts": ("jitter", "gaps beyond 44 ms, 320 ms the longest"),
    "falls-silent": ("staleness", "joint_1 was without an angle for 3.2. s"),
    "half-rate": ("rate", "JOINTS_1_2: 62.50 Hz, 125 Hz in the arm file"),
    "missing-message": ("messages", "JOINTS_5_6 never came"),
    "not-available": ("scale", "frames of JOINTS_3_4 cannot be used: .* not available"),
    "out-of-range": ("scale", "joint_2 is reported at 300.00 to 300.00 degrees"),
    "shaky": ("still", "joint_1 moves by 0.200 degree"),
    "skips-frames": ("counter", "JOINTS_1_2: .* frames lost by the counter"),
    "stuck-counter": ("counter", "the counter stands still in 49. frames"),
    "torn-lines": ("line", "lines of the adapter are no frame"),
    "unknown-state": ("drive-state", "state 9 is not one of 0 OFF"),
}


class ToldClock:
    def __init__(self):
        self._now_s = 50.0

    def now_s(self):
        return self._now_s

    def sleep(self, lab_s):
        self._now_s += lab_s

    def wall_s(self, lab_s):
        return lab_s


class Bus:
    """A controller and its adapter, heard on a clock that is told."""

    name = "told"
    confirmed_silent = True
    error_frames = 0
    cycle_s = 0.008

    def __init__(self, arm, alteration, *, state=HELD):
        self.alteration = alteration
        self.encoder = CanEncoder(arm.can)
        self.angles = {joint.name: 0.1 for joint in arm.joints}
        self.state = state
        self.parser = SlcanParser()
        self.status_flags = None
        self.begin_s = None
        self.cycle = 0
        self.fetched = []

    @property
    def faults(self):
        return self.parser.faults

    def fileno(self):
        return -1

    def ask_status(self):
        self._hear(b"F00\r", None)

    def _hear(self, lines, now_s):
        items = self.parser.feed(self.alteration.to_host(lines))
        for item in items:
            if isinstance(item, SlcanReply):
                self.status_flags = (self.status_flags or 0) | int(item.text[1:], 16)
        frames = [item for item in items if isinstance(item, CanFrame)]
        if now_s is not None:
            self.fetched.append((now_s, frames))

    def collect(self, now_s):
        self.begin_s = now_s if self.begin_s is None else self.begin_s
        lines = b""
        while self.cycle * self.cycle_s <= now_s - self.begin_s:
            frames = self.encoder.encode(self.angles, drive_state=self.state, counter=self.cycle)
            lines += b"".join(encode_slcan(f.can_id, f.data) for f in frames)
            self.cycle += 1
        self._hear(lines, now_s)

    def take(self):
        fetched, self.fetched = self.fetched, []
        return fetched

    def close(self):
        pass


@pytest.fixture
def check(arm, monkeypatch):
    def run(alteration, *only, arm=arm, **options):
        bus = Bus(arm, alteration, **options)
        monkeypatch.setattr(can_check, "open_can", lambda channel, bitrate: bus)
        return can_check.check_can("told", arm, duration_s=DURATION_S, clock=ToldClock(), only=only)

    return run


def test_every_step_passes_on_a_healthy_bus(check):
    report = check(BrokenController())
    assert {step.name: step.came for step in report.steps if step.verdict is not Verdict.PASS} == {}
    assert len(report.steps) == len(CAN_STEPS)


def test_every_broken_controller_has_a_step_that_catches_it():
    assert CAUGHT.keys() == BROKEN_CONTROLLERS.keys()


@pytest.mark.parametrize(
    "name", every_but(CAUGHT, "skips-frames", "out-of-range", "shaky", "half-rate", "falls-silent")
)
def test_a_broken_controller_is_caught_by_its_step(check, name):
    step, reason = CAUGHT[name]
    report = check(broken_controller(name))
    result = report.step(step)
    assert result.verdict is Verdict.FAIL
    assert re.search(reason, result.came), result.came
    assert result.hint
    assert not report.passed


@pytest.mark.parametrize(
    "name", ["half-rate", "out-of-range", "shaky", "skips-frames", "falls-silent"]
)
def test_a_single_fault_fails_no_other_step(check, name):
    report = check(broken_controller(name))
    failing = {step.name for step in report.steps if step.verdict is Verdict.FAIL}
    assert failing == {CAUGHT[name][0]}


def test_a_bus_on_which_nothing_is_heard_names_the_causes(check):
    class Silent(BrokenController):
        def frame(self, frame):
            return b""

    result = check(Silent()).step("acknowledged")
    assert result.verdict is Verdict.FAIL
    assert "nobody acknowledges" in result.came
    assert "error-passive" in result.hint


def test_a_moving_arm_is_not_checked_for_rest(check):
    report = check(BrokenController(), state=MOVING)
    assert report.step("still").verdict is Verdict.NOT_CHECKED
    assert report.step("drive-state").verdict is Verdict.NOT_CHECKED
    assert report.passed


def test_what_the_arm_file_does_not_name_is_not_checked(check, arm):
    bare = replace(arm, can=replace(arm.can, counter=None, drive_state=None))
    report = check(BrokenController(), arm=bare)
    for name in ("counter", "drive-state"):
        assert report.step(name).verdict is Verdict.NOT_CHECKED
    assert report.passed


def test_an_interface_that_cannot_confirm_silence_is_not_checked_for_it(check, monkeypatch):
    monkeypatch.setattr(Bus, "confirmed_silent", False)
    assert check(BrokenController(), "listening").steps[0].verdict is Verdict.NOT_CHECKED


def test_a_coarse_bit_is_told(check, arm):
    coarse = tuple(replace(j, scale_rad=j.scale_rad * 1000.0) for j in arm.can.joints)
    report = check(BrokenController(), arm=replace(arm, can=replace(arm.can, joints=coarse)))
    # 0.0001 degree a bit of the database, taken a thousandfold.
    assert "a bit is 0.1 degree" in report.step("resolution").came


def test_what_cannot_be_checked_at_all_is_refused(arm):
    with pytest.raises(ArmError, match=r"wanted a \[can\] section"):
        check_can("/dev/null", replace(arm, can=None))
    with pytest.raises(CanError, match="CAN channel"):
        check_can("nothing", arm)
    with pytest.raises(CheckError, match="wanted steps"):
        check_can("nothing", arm, only=["colour"])
    with pytest.raises(PlantError, match="wanted a broken controller there is"):
        broken_controller("colour")
