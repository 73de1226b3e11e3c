"""Joint angles told by a person: no bus, no hit before his word, and the session says so."""

import math

import numpy as np
import pytest
from support.acquisition_run import strike

from armodal.daq.commands import Ready, StatedPosture, Stop
from armodal.daq.events import JointsSeen
from armodal.daq.session_machine import PromptKind
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.journal import MarkKind, load_journal, read_journal
from armodal.protocols.session.recovery import rebuild

TOLD = {"can_channel": "", "told_tolerance_rad": math.radians(0.2)}
SECOND = """
[[postures]]
name = "test 2"
joints_deg = [25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
tolerance_deg = 0.5
points = ["2"]
hit_direction = [0.0, -1.0, 0.0]
"""


@pytest.fixture
def by_hand(lab, start):
    lab.controller.unplug()  # there is no bus
    return lambda **changes: start(**{**TOLD, **changes})


def tell(run, **word):
    run.prompt(PromptKind.POSTURE)
    run.ours.send(StatedPosture(**word))


def test_no_point_is_asked_for_before_the_operator_has_told_the_posture(lab, by_hand, fakes):
    run = by_hand()
    run.prompt(PromptKind.POSTURE)
    assert run.until(lambda e: isinstance(e, JointsSeen)).reading.joints_rad is None
    block = strike(lab, fakes["record"]())
    assert f"block {block} " in run.noted("not used").text
    run.ours.send(StatedPosture())
    run.prompt(PromptKind.POINT)


def test_a_session_by_hand_is_kept_as_told(lab, by_hand, fakes, tmp_path):
    run = by_hand(told_tolerance_rad=np.radians(0.2))  # a number of numpy's is one too
    tell(run)
    run.ready()
    strike(lab, fakes["record"]())
    hit = run.judged()
    assert hit.verdict.accepted
    run.end()
    session = load_journal(lab.journal)
    assert session.header.told_tolerance_rad == math.radians(0.2)
    assert session.warnings[0].startswith("joint angles were told by the operator, to 0.2 deg")
    (kept,) = session.hits
    for reading in (kept.before, kept.after):
        np.testing.assert_array_equal(reading.joints_rad, lab.plan.postures[0].joints_rad)
    marks = read_journal(lab.journal).marks
    assert any(m.kind is MarkKind.NOTE and "and held" in m.note for m in marks)
    rebuild(lab.journal, tmp_path / "s.h5", software="test", estimate_frfs=lambda _: ())
    derived = read_session(tmp_path / "s.h5")
    assert derived.header.told_tolerance_rad == math.radians(0.2)
    assert derived.warnings == session.warnings


def test_angles_off_the_posture_are_refused_and_asked_for_again(lab, by_hand):
    run = by_hand()
    off = lab.plan.postures[0].joints_rad + math.radians(0.4)
    tell(run, joints_rad=tuple(off))
    run.noted("not taken")
    run.ours.send(StatedPosture(joints_rad=tuple(off - math.radians(0.2))))
    run.prompt(PromptKind.POINT)


def test_every_posture_is_told_anew(lab, by_hand, fakes, arm):
    text = lab.plan.text.replace('["2", "3"]', '["2"]').replace("point = 2", "point = 1") + SECOND
    run = by_hand(plan=plan_from_text(text, arm))
    tell(run)
    run.ready()
    strike(lab, fakes["record"]())
    assert run.prompt(PromptKind.POSTURE).posture.name == "test 2"
    run.ours.send(Ready())
    run.noted("ready came before the arm was at its posture")
    run.ours.send(StatedPosture())
    run.prompt(PromptKind.POINT)


def test_told_and_measured_are_never_one_session(lab, by_hand):
    run = by_hand()
    tell(run)
    run.prompt(PromptKind.POINT)
    run.ours.send(Stop())
    run.end()
    again = by_hand(resume=True, can_channel=lab.controller.name, told_tolerance_rad=None)
    assert "told by hand to 0.2 deg, and now they would be measured" in again.failure().message


def test_what_is_measured_is_not_told(start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.send(StatedPosture())
    run.noted("was not taken from the operator")
