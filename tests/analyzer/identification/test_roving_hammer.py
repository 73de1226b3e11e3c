"""The test the other way round: one sensor, the hammer goes about."""

from __future__ import annotations

import numpy as np
import pytest
from support.offline_lab import simulate_session

from armodal.analyzer.identification.identify import identify
from armodal.analyzer.report import write_report
from armodal.analyzer.screws import line_angle_rad, line_distance_m
from armodal.hil_sim.plant import load_plant


@pytest.fixture(scope="module")
def session():
    return simulate_session(2, plan="rv4frl-roving-hammer")


@pytest.fixture(scope="module")
def result(session):
    return identify(session)


def test_joints_and_the_hidden_axis_are_found_from_one_sensor(result):
    plant = load_plant("rv4frl")
    springs = [link for link in plant.truth.links if link.stiffness_n_m_per_rad]
    for joint, spring in zip(result.joints, springs, strict=True):
        error = joint.k_n_m_per_rad - spring.stiffness_n_m_per_rad
        assert abs(error) < 0.02 * spring.stiffness_n_m_per_rad
        assert abs(error) < 3 * joint.k_std
    (axis,) = result.axes
    hidden = plant.truth.hidden_axis
    assert axis.link == hidden.link
    error = axis.k_n_m_per_rad - hidden.stiffness_n_m_per_rad
    assert abs(error) < min(0.05 * hidden.stiffness_n_m_per_rad, 3 * axis.k_std)
    assert np.rad2deg(line_angle_rad(axis.direction_link, hidden.direction)) < 3
    assert line_distance_m(hidden.point_m, axis.point_link_m, axis.direction_link) < 0.015


def test_shapes_are_taken_where_the_hammer_went(result):
    """One triaxial sensor tells three numbers a mode; eight hits tell which modes joints make."""
    structural = [mode for mode in result.modes if mode.structural]
    assert 78.0 < max(mode.f_hz for mode in structural) < 80.0
    assert any(mode.joint_share > 0.99 for mode in result.modes)


def test_the_report_is_written(session, result, tmp_path):
    path = tmp_path / "report.html"
    write_report(session, result, path)
    assert "joint_1" in path.read_text(encoding="utf-8")
