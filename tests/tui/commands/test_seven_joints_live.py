"""A robot description of seven joints, measured over board and bus as a user would."""

from __future__ import annotations

import json
import math

import pytest
from support.command import armodal
from support.robot_files import seven_joints

from armodal.analyzer.identification.identify import identify
from armodal.hil_sim.lab import start_laboratory
from armodal.hil_sim.ledger import read_ledger
from armodal.hil_sim.rehearsal import Rehearsal
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.generic_can import with_generic_can
from armodal.protocols.plan import load_plan
from armodal.protocols.session.hdf5 import read_session

TIME_SCALE = 16.0
WITHIN = 3.0  # stated deviations, joint by joint: 1 in 50 seeds leaves it with 7 joints


@pytest.fixture(scope="module")
def live(tmp_path_factory, small_search):
    """The new arm's folder, its session measured live, and the true springs."""
    folder = tmp_path_factory.mktemp("seven")
    (folder / "robot.urdf").write_text(seven_joints().urdf())
    file, plan = folder / "arm" / "robot.toml", folder / "plan.toml"
    for step in (
        ("arm", "new", folder / "robot.urdf", "--yes", "--no-plan", "--out", folder / "arm"),
        ("plan", file, "--tests", "4", "--minutes", "110", "--out", plan),
    ):
        said = armodal(*step)
        assert said.returncode == 0, said.stderr
    arm = with_generic_can(load_arm(file))
    rehearsal = Rehearsal(arm=arm, plan=load_plan(plan, arm))
    journal = folder / "s.journal"
    with start_laboratory(
        rehearsal, seed=5, time_scale=TIME_SCALE, directory=folder / "lab"
    ) as laboratory:
        done = armodal(
            "acquire", plan, "--arm", file, "--board", laboratory.board, "--can", laboratory.can,
            "--operator", laboratory.operator, "--time-scale", TIME_SCALE, "--journal", journal,
            "--json",
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder, json.loads(done.stdout), read_ledger(laboratory.ledger)


@pytest.mark.long
def test_a_session_of_seven_joints_is_whole_and_holds_every_joints_angle(live):
    folder, told, _ = live
    assert told["complete"]
    session = read_session(folder / "s.h5")
    plan = session.header.plan
    assert len(session.header.arm.joints) == 7
    for posture in plan.postures:
        hits = [h for h in session.hits if h.posture == posture.name and h.verdict.accepted]
        assert len(hits) == plan.hits_per_point * len(posture.points)
        for hit in hits:
            assert len(hit.before.joints_rad) == 7
            off = max(
                abs(a - b) for a, b in zip(hit.before.joints_rad, posture.joints_rad, strict=True)
            )
            assert off < math.radians(0.5)


@pytest.mark.long
def test_the_springs_of_seven_joints_are_found_within_their_stated_deviations(live):
    folder, _, ledger = live
    truth = {joint.name: joint.k_n_m_per_rad for joint in ledger.truth.joints}
    found = identify(read_session(folder / "s.h5")).joints
    assert len(found) >= 5  # the wrist's last may be rigid
    for joint in found:
        std = math.hypot(joint.k_std, joint.k_std_model)
        assert abs(joint.k_n_m_per_rad - truth[joint.joint]) < WITHIN * std, joint
