"""Joints beside bearings, links and base that give way: another maker's arm, and an axis in it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.identification.as_effects import identified_arm
from armodal.analyzer.identification.beside_ordinary import BesideOrdinary
from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.records import Explained
from armodal.analyzer.identification.scatter import stated_half_width_95
from armodal.hil_sim.makers import make_case
from armodal.protocols.arm.files import load_arm

# Of an estimate whose 95 % interval is 1.96 deviations: one joint of six beyond in 60 sessions.
SURE = 3.0 / 1.96


def truth(case):
    return json.loads(case.open_truth())


@pytest.fixture(scope="module")
def sound():
    return make_case("frame", 6, "lrmate200id")


@pytest.fixture(scope="module")
def session(sound):
    return sound.session()


@pytest.fixture(scope="module")
def found(session):
    return identify(session)


@pytest.mark.long
def test_a_sound_elastic_arm_has_its_stiffnesses_and_no_axis(sound, found):
    """Beams and six-way springs: joints alone leave a third, and are up to a tenth too soft."""
    assert found.explained_by is Explained.ORDINARY
    assert found.axes == ()
    true = truth(sound)["joints"]
    for row in found.joints:
        k = true[row.joint]["stiffness_n_m_per_rad"]
        assert abs(row.k_n_m_per_rad - k) < SURE * stated_half_width_95(row)
    assert any("k alone" in note for note in found.notes)
    # Every point was hit at three levels: what depends on them is gap's to tell.
    assert any("soft and hard hits are averaged" in note for note in found.notes)


@pytest.mark.long
def test_postures_that_were_not_fitted_are_foretold_within_their_deviations(found):
    """By joints alone a mode of them is 13 % off, at a stated 0.1 %."""
    paired = [row for row in found.validation if row.measured_hz is not None]
    low = [row for row in paired if row.predicted_hz < 120.0]
    assert len(low) >= 9  # of eleven: two more have no peak of their own
    for row in low:
        assert row.predicted_std_hz < 0.01 * row.predicted_hz
    for row in paired:
        std = np.hypot(row.predicted_std_hz, row.measured_std_hz)
        # Of a dozen comparisons one is beyond four deviations once in a thousand sessions.
        assert abs(row.predicted_hz - row.measured_hz) < 4.0 * std


@pytest.mark.long
def test_an_export_has_what_joints_alone_need(session, found):
    """Nothing else gives way in it: with the drives' own stiffness its modes would be too high."""
    arm = identified_arm(
        session.header.arm, found, source="a test", session_sha256="0" * 64, created="2026"
    )
    own = {joint.name: joint.stiffness for joint in arm.joints if joint.stiffness is not None}
    for row in found.joints:
        assert own[row.joint].value == row.k_alone_n_m_per_rad
        assert row.k_alone_n_m_per_rad != row.k_n_m_per_rad


@pytest.mark.long
def test_one_posture_cannot_tell_what_else_gives_way(session):
    plan = session.header.plan
    one = replace(plan, postures=plan.postures[:1])
    hits = tuple(hit for hit in session.hits if hit.posture == one.postures[0].name)
    alone = identify(replace(session, header=replace(session.header, plan=one), hits=hits))
    assert alone.explained_by is Explained.NOTHING
    (said,) = [note for note in alone.notes if "cannot be told" in note]
    assert "at least 2 postures" in said
    assert all(row.k_n_m_per_rad == row.k_alone_n_m_per_rad for row in alone.joints)


@pytest.mark.parametrize("u", [0.0, 1.0])
def test_an_axis_of_the_arm_file_that_gives_way_by_nothing_is_said(u):
    ordinary = Ordinary(superset=Superset(load_arm("bench57")), postures=())
    axis = link_axis.at_axis(ordinary, 1, np.eye(3)[0], np.zeros(3))
    space = Space(axis.parameters)
    at = np.array([u * (p.name == axis.size) for p in space.parameters])
    fit = made_fit(Hypothesis(ordinary=ordinary, instances=(axis,)), cost=1.0, space=space, u=at)
    beside = BesideOrdinary(stages=(), start={}, fit=fit)
    assert beside.locked_axes() == ((axis.place,) if u == 0.0 else ())
    if u == 0.0:
        assert beside.axes() == ()


@pytest.mark.long
def test_an_axis_beside_bearings_is_found_with_its_stiffness():
    case = make_case("mujoco", 2, "lrmate200id", "link_axis", "clear")
    found = identify(case.session())
    (effect,) = truth(case)["effects"]
    (axis,) = found.axes
    assert axis.link == effect["place"]
