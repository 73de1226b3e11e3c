"""A log of motion beside somebody's MJCF, against the linear equations of small motions."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from support.added import axis, with_effects
from support.own_mjcf import own_mjcf

from armodal.analyzer.arm.reduced import selection
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.simulator.motion import beside_motion
from armodal.analyzer.simulator.motion_page import motion_figure, motion_page
from armodal.protocols.errors import ArmError, EstimateError
from armodal.protocols.foreign.motion_log import MotionLog

mujoco = pytest.importorskip("mujoco")

RATE_HZ, POINT = 1000.0, "1"
Q = np.array([0.2, 0.5, 1.0, 0.1, 0.6, 0.0])
STILL_S = 2.0
SMALL_RAD = 2e-5  # products of two such motions are next to nothing


def logged(arm, corrected, seconds=5.0):
    """What a corrected arm's accelerometer reads while drives 1 to 3 shake about a posture."""
    ready = held_arm(corrected)
    superset = Superset(ready.arm)
    believed = believed_structure(ready.arm)
    structure = type(believed)(
        joints=believed.joints,
        stiffness_n_m_per_rad=believed.stiffness_n_m_per_rad,
        damping_n_m_s_per_rad=believed.damping_n_m_s_per_rad,
        axes=ready.axes,
        held=ready.held,
    )
    posture = superset.posture(Q)
    T = selection(superset, structure)
    D = np.eye(superset.n)[:, [superset.joint_column(i) for i in range(3)]]
    M, K, C = T.T @ posture.mass @ T, structure.springs(), structure.dampers()
    t = np.arange(int(seconds * RATE_HZ)) / RATE_HZ
    rng = np.random.default_rng(4)
    sos = scipy.signal.butter(3, (6.0, 60.0), "bandpass", fs=RATE_HZ, output="sos")
    # Still at the end until what rings has died away, or it would be there at the beginning.
    window = np.clip(np.minimum(t, t[-1] - STILL_S - t) / 0.5, 0.0, 1.0)[:, None]
    angles = SMALL_RAD * window * scipy.signal.sosfilt(sos, rng.normal(size=(len(t), 3)), axis=0)
    # In the frequency domain, the log repeated: M (x'' + d'') + C x' + K x = 0.
    s = 2j * np.pi * np.fft.rfftfreq(len(t), 1.0 / RATE_HZ)
    d = np.fft.rfft(angles, axis=0)
    J = posture.point_jacobian[superset.point_index[POINT], :3]
    acc = np.zeros((len(s), 3), dtype=complex)
    for i, (own, drive) in enumerate(zip(s, d, strict=True)):
        load = -(T.T @ posture.mass @ D) @ (own**2 * drive)
        x = np.linalg.solve(own**2 * M + own * C + K, load)
        acc[i] = own**2 * (J @ (T @ x + D @ drive))
    R = posture.point_rotation[superset.point_index[POINT]]
    whole = np.tile(Q, (len(t), 1))
    whole[:, :3] += angles
    return MotionLog(
        rate_hz=RATE_HZ,
        slowest_hz=RATE_HZ,
        encoder_rad=whole,
        command_rad=None,
        acceleration_m_s2={POINT: np.fft.irfft(acc, len(t), axis=0) @ R},
        unused=(),
    )


@pytest.fixture(scope="module")
def model(arm, tmp_path_factory):
    path = tmp_path_factory.mktemp("mine") / "mine.xml"
    path.write_text(own_mjcf(arm), encoding="utf-8")
    return path


def test_the_gap_closes_for_the_true_effect_and_not_for_a_null(arm, model):
    corrected = with_effects(arm, axis("shoulder"))
    true, null = (
        beside_motion(logged(arm, own), arm, corrected, model, mujoco, lambda _: None)[0]
        for own in (corrected, arm)
    )
    # Gravity turns in the simulated sensor: 2 % of the rigid motion at the band's low end.
    assert true.error_after < 0.02
    assert true.error_before > 0.1
    assert null.error_before < 0.02
    assert null.error_after > 0.1


def test_a_page_shows_measured_plain_and_corrected_in_time_and_by_frequency(arm, model):
    corrected = with_effects(arm, axis("shoulder"))
    log = logged(arm, corrected)
    (row,) = beside_motion(log, arm, corrected, model, mujoco, lambda _: None)
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
    log = logged(arm, arm, seconds=1.0)
    with pytest.raises(ArmError, match="without points 1; give"):
        beside_motion(log, other, arm, model, mujoco, lambda _: None)


def test_a_short_or_slow_log_is_refused(arm, model):
    log = logged(arm, arm, seconds=1.0)
    with pytest.raises(EstimateError, match="wanted a log of at least"):
        beside_motion(log, arm, arm, model, mujoco, lambda _: None)
    with pytest.raises(EstimateError, match="rows a second"):
        beside_motion(
            replace(log, rate_hz=20.0, slowest_hz=20.0), arm, arm, model, mujoco, lambda _: None
        )
