"""A log of motion beside somebody's MJCF, against the linear equations of small motions."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.added import axis, with_effects
from support.linear_log import linear_log
from support.own_mjcf import own_mjcf
from support.robot_files import box_stl

from armodal.analyzer.simulator.comparison import simulated_arm
from armodal.analyzer.simulator.encoder_noise import read_by_noise
from armodal.analyzer.simulator.in_time import standing_model
from armodal.analyzer.simulator.motion import FOLLOWS, compare_with_motion
from armodal.analyzer.simulator.motion_page import motion_figure, motion_page
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.errors import ArmError, EstimateError

mujoco = pytest.importorskip("mujoco")

pytestmark = pytest.mark.usefixtures("not_apart")

RATE_HZ, POINT = 1000.0, "1"
Q = np.array([0.2, 0.5, 1.0, 0.1, 0.6, 0.0])


def logged(corrected, seconds=4.0):
    return linear_log(corrected, Q, point=POINT, seconds=seconds, rate_hz=RATE_HZ)


@pytest.fixture(scope="module")
def corrected(arm):
    return with_effects(arm, axis("shoulder"))


@pytest.fixture(scope="module")
def log(corrected):
    """What the corrected arm's accelerometer reads."""
    return logged(corrected)


@pytest.fixture(scope="module")
def model(arm, tmp_path_factory):
    path = tmp_path_factory.mktemp("mine") / "mine.xml"
    path.write_text(own_mjcf(arm), encoding="utf-8")
    return path


@pytest.mark.long
def test_the_gap_closes_for_the_true_effect_and_not_for_a_null(arm, corrected, model):
    true, null = (
        compare_with_motion(logged(own), arm, corrected, model, mujoco, lambda _: None)[0]
        for own in (corrected, arm)
    )
    # Gravity turns in the simulated sensor: 2 % of the rigid motion at the band's low end.
    assert true.error_after < 0.02
    assert true.error_before > 0.1
    assert null.error_before < 0.02
    assert null.error_after > 0.1


def test_a_page_shows_measured_plain_and_corrected_in_time_and_by_frequency(
    arm, corrected, log, model
):
    (row,) = compare_with_motion(log, arm, corrected, model, mujoco, lambda _: None)
    assert len(row.time_s) == len(row.measured_m_s2) == len(row.before_m_s2)
    off = row.after_m_s2 - row.measured_m_s2
    assert np.linalg.norm(off) < 0.02 * np.linalg.norm(row.measured_m_s2)
    figure = motion_figure(row)
    assert [trace.name for trace in figure.data if trace.xaxis == "x"] == [
        "measured",
        "plain arm",
        "corrected arm",
    ]
    density = {trace.name: np.asarray(trace.y) for trace in figure.data if trace.xaxis == "x2"}
    # Of the densities, that of what the corrected arm is off is below the plain arm's.
    assert np.mean(density["corrected arm, off"] ** 2) < 0.05 * np.mean(
        density["plain arm, off"] ** 2
    )
    said = motion_page("mine", [row], ["first & second"])
    assert "first &amp; second" in said
    assert "corrected arm" in said


def test_a_log_of_other_joints_or_points_is_refused(arm, model):
    other = replace(arm, name="other", points=arm.points[1:])
    log = logged(arm, seconds=1.0)
    with pytest.raises(ArmError, match="without points 1; give"):
        compare_with_motion(log, other, arm, model, mujoco, lambda _: None)


def test_a_short_or_slow_log_is_refused(arm, model):
    log = logged(arm, seconds=1.0)
    with pytest.raises(EstimateError, match="wanted a log of at least"):
        compare_with_motion(log, arm, arm, model, mujoco, lambda _: None)
    with pytest.raises(EstimateError, match="rows a second"):
        compare_with_motion(
            replace(log, rate_hz=20.0, slowest_hz=20.0), arm, arm, model, mujoco, lambda _: None
        )


def test_drives_follow_commands_where_encoders_are_too_noisy_and_without_them_it_is_refused(
    arm, corrected, log, model
):
    noise = np.random.default_rng(1).normal(0.0, 1e-5, log.encoder_rad.shape)
    noisy = replace(log, encoder_rad=log.encoder_rad + noise)
    said = []
    with pytest.raises(EstimateError, match="more than they are noisy"):
        compare_with_motion(noisy, arm, corrected, model, mujoco, said.append)
    assert said == []
    commanded = replace(noisy, command_rad=log.encoder_rad)
    (row,) = compare_with_motion(commanded, arm, corrected, model, mujoco, said.append)
    assert said[0].startswith(FOLLOWS)
    assert row.error_after < 0.02
    assert row.moved == pytest.approx(1.0, abs=0.02)


def test_noise_of_angles_is_told_as_what_their_second_derivative_reads(arm):
    """Of white noise at one joint: twice differentiated in the band, times the lever."""
    rng = np.random.default_rng(3)
    angles = np.tile(Q, (20_000, 1))
    angles[:, 0] += rng.normal(0.0, 1e-5, len(angles))
    told = read_by_noise(arm, angles, RATE_HZ, (5.0, 50.0), POINT)
    f = np.fft.rfftfreq(len(angles), 1.0 / RATE_HZ)
    inside = (f > 5.0) & (f < 50.0)
    turning = np.fft.irfft(
        inside * (2.0 * np.pi * f) ** 2 * np.fft.rfft(angles[:, 0] - Q[0]), len(angles)
    )
    moved = (point_place(arm, POINT, Q + 1e-6 * np.eye(6)[0]) - point_place(arm, POINT, Q)) / 1e-6
    # The floor is a median of some 20 segments' bins, each a chi-square of two degrees.
    assert told == pytest.approx(np.std(turning) * np.linalg.norm(moved), rel=0.1)


def point_place(arm, point_id, q):
    point = arm.point(point_id)
    return (link_pose(arm, point.link, q) @ [*point.position_m, 1.0])[:3]


@pytest.mark.long
def test_meshes_of_the_user_are_found_from_the_user_s_folder(arm, tmp_path, monkeypatch):
    """Of a file that is named from elsewhere, its meshes in a folder beside it."""
    mine = tmp_path / "mine"
    (mine / "assets").mkdir(parents=True)
    box_stl(mine / "assets" / "skin.stl", (0.1, 0.1, 0.1))
    text = own_mjcf(arm).replace('angle="radian"', 'angle="radian" meshdir="assets"')
    text = text.replace("<worldbody>", '<asset><mesh file="skin.stl"/></asset><worldbody>')
    text = text.replace('type="sphere" size="0.05"', 'type="mesh" mesh="skin"')
    (mine / "mine.xml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    own = simulated_arm(arm, Path("mine/mine.xml"), mujoco)
    model, _, _ = standing_model(own, [POINT], Q, RATE_HZ)
    assert model.nmesh == 1
