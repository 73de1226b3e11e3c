"""A healthy board passes; each broken one is caught by the step that looks for its fault."""

import re
from fractions import Fraction

import pytest
from support.virtual_board import VirtualAdapter, VirtualBoard

from armodal.daq.check import (
    BOARD_STEPS,
    BoardCheckOptions,
    CheckError,
    Verdict,
    check_board,
)
from armodal.daq.serial_port import SerialPort
from armodal.hil_sim.broken_board import BROKEN_BOARDS, broken_board
from armodal.protocols.errors import DeviceTimeoutError, FrameError, PlantError, PortError

OPTIONS = BoardCheckOptions(duration_s=3.0, rate_hz=Fraction(51_200, 8))

CAUGHT = {
    "any-session": ("session", "WRONG_SESSION wanted, got OK"),
    "cuts-long-commands": ("rates", "a byte too many: BAD_VALUE wanted, got OK"),
    "deaf-to-malformed": ("rates", "a byte too few: BAD_VALUE wanted, no answer came"),
    "deaf-to-other-versions": ("version", "HELLO of version 2: HELLO_REPLY wanted, no answer"),
    "deaf-to-unknown": ("commands", "UNKNOWN_COMMAND wanted, no answer came"),
    "dies-on-garbage": ("garbage", "not answered STATUS since a stretch longer than any frame"),
    "fast-clock": ("clock", r"the clock drifts: \+[45]\d\d\d ppm"),
    "forgets-on-reconnect": ("reconnect", "session .* became .* started anew"),
    "half-counted": ("stream-overflow", "samples are missing, STATUS owns up to"),
    "hash-lost": ("framing", "frames carry dictionary hash 0"),
    "late-pretrigger": ("pretrigger", "77 samples before the trigger wanted, 74 came"),
    "late-trigger": ("trigger", "which is no rising crossing"),
    "new-session": ("hello-again", "session .* became"),
    "no-counts": ("stream-overflow", "samples are missing, STATUS owns up to 0"),
    "no-flags": ("block-overflow", "the flag BLOCK is not set"),
    "obeys-torn-frames": ("garbage", "after a STOP with a wrong CRC the board is CONFIGURED"),
    "other-resend": ("resend", "200 samples differ from the first sending"),
    "refuses-nothing": ("rates", r"to be refused with LINK .* was accepted"),
    "refuses-without-reason": ("rates", "without a reason"),
    "scale-in-another-unit": ("dictionary", "scale x largest count is .* full scale"),
    "silent-skip": ("samples", r"the sample index jumps .* STATUS owns up to \d"),
    "slow-samples": ("rate", r"-11\d\d\d\d ppm from 6400 Hz"),
    "stuck-sequence": ("framing", "the sequence number does not rise"),
    "ticks-backwards": ("clock", "ticks run backwards"),
    "twice-sent": ("samples", "frames bring samples again"),
    "wrong-crc": ("framing", "stretches are no frame, most for CRC-32"),
    "wrong-hash": ("dictionary", "the header of HELLO_REPLY says"),
    "wrong-slope": ("trigger", "which is no falling crossing"),
}


def check(device, *only):
    return check_board(device.open, OPTIONS, clock=device.clock, only=only)


def test_every_step_passes_on_a_healthy_board(plant):
    report = check(VirtualBoard(plant))
    assert {step.name: step.came for step in report.steps if step.verdict is not Verdict.PASS} == {}
    assert len(report.steps) == len(BOARD_STEPS)
    assert report.passed


def test_a_board_that_answers_what_is_too_long_passes_too(plant):
    # A byte more than the longest command: read and refused with BAD_VALUE, not passed over.
    report = check(VirtualBoard(plant, receive_bytes=256), "rates")
    assert {step.name: step.came for step in report.steps if step.verdict is not Verdict.PASS} == {}


def test_every_broken_board_has_a_step_that_catches_it():
    assert CAUGHT.keys() == BROKEN_BOARDS.keys() - {"none"}


def test_every_step_has_a_broken_board_that_it_catches():
    # Every rate by ticks is what slow-samples fails as well, but then the long run is enough.
    assert {step for step, _ in CAUGHT.values()} == {s.name for s in BOARD_STEPS} - {"each-rate"}


def test_a_wrong_rate_is_seen_in_the_ticks_too(plant):
    (result,) = check(VirtualBoard(plant, broken_board("slow-samples")), "each-rate").steps
    assert "51200 Hz asked for, 25600 Hz by its own ticks (-50.00 %)" in result.came


@pytest.mark.parametrize("name", CAUGHT)
def test_a_broken_board_is_caught_by_its_step(plant, name):
    step, reason = CAUGHT[name]
    report = check(VirtualBoard(plant, broken_board(name)), step)
    (result,) = report.steps
    assert result.verdict is Verdict.FAIL
    assert re.search(reason, result.came), result.came
    assert result.hint
    assert not report.passed


def test_a_board_that_has_died_leaves_the_rest_unchecked(plant):
    report = check(VirtualBoard(plant, broken_board("dies-on-garbage")), "garbage", "session")
    assert [step.verdict for step in report.steps] == [Verdict.FAIL, Verdict.NOT_CHECKED]
    assert "no longer answers" in report.step("session").came


def test_a_port_that_is_not_there_is_no_check():
    with pytest.raises(PortError, match="no such device"):
        check_board(lambda: SerialPort("/dev/armodal-none"), OPTIONS)


def test_a_device_that_is_no_board_is_told(plant):
    # The CAN adapter answers with BEL where there is no CR, and with nothing else.
    with pytest.raises((DeviceTimeoutError, FrameError), match="HELLO"):
        check(VirtualAdapter())


def test_an_unknown_step_and_an_unknown_board_are_refused(plant):
    with pytest.raises(CheckError, match="wanted steps of this check"):
        check(VirtualBoard(plant), "colour")
    with pytest.raises(PlantError, match="wanted a broken board there is"):
        broken_board("colour")


def test_a_report_as_json_holds_every_step(plant):
    said = check(VirtualBoard(plant), "dictionary", "session").as_json()
    assert said["passed"] is True
    assert [step["name"] for step in said["steps"]] == ["dictionary", "session"]
    assert {step["verdict"] for step in said["steps"]} == {"pass"}
