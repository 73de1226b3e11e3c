"""The wrist's centre by geometry, and where maps over it make sense."""

import numpy as np
import pytest
from support.chain_arm import chain_arm
from support.dh_arm import dh_arm

from armodal.analyzer.workspace.maps import map_frequencies
from armodal.analyzer.workspace.meridian import ELBOWS, meridian_plane
from armodal.analyzer.workspace.spectrum import ElasticJoints
from armodal.analyzer.workspace.wrist import axis_lines, wrist_centre
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

# Modified DH rows (alpha in deg, a, d in m): a UR's, whose last axes do not cross; a seven-axis arm
# with a spherical wrist; and five axes.
UR10E = (
    (0, 0, 0.1807), (90, 0, 0), (0, -0.6127, 0), (0, -0.57155, 0.17415),
    (90, 0, 0.11985), (-90, 0, 0.11655),
)  # fmt: skip
SEVEN = (
    (0, 0, 0.36), (-90, 0, 0), (90, 0, 0.42), (90, 0, 0),
    (-90, 0, 0.4), (-90, 0, 0), (90, 0, 0.126),
)  # fmt: skip
FIVE = ((0, 0, 0.1), (90, 0.03, 0), (0, 0.155, 0), (0, 0.135, 0), (90, 0, 0.2))
SCARA = ((0, 0, 0.2), (0, 0.3, 0), (0, 0.3, 0), (0, 0.0, 0), (0, 0.0, 0))


def distances(arm, q, point):
    points, directions = axis_lines(arm, q)
    return np.linalg.norm(np.cross(points - point, directions), axis=1)


@pytest.mark.parametrize("name", ["viper_s650", "rv4frl", "bench57"])
def test_a_spherical_wrists_centre_lies_on_its_three_axes_in_every_posture(name):
    arm = load_arm(name)
    for seed in range(3):
        q = np.random.default_rng(seed).uniform(-1.0, 1.0, len(arm.joints))
        found = wrist_centre(arm, q)
        assert found.gap_m < 1e-12
        np.testing.assert_allclose(distances(arm, q, found.point_m)[3:], 0.0, atol=1e-12)


def test_axes_that_do_not_cross_leave_a_gap_that_is_told():
    arm = dh_arm(UR10E)
    found = wrist_centre(arm, np.zeros(6))
    # Axes 4 and 6 are parallel and 0.11985 m apart, axis 5 crosses both: half way.
    assert found.gap_m == pytest.approx(0.11985 / 2, abs=1e-12)
    assert "60 mm from the farthest" in found.words(arm)


def test_no_other_point_is_nearer_to_the_axes():
    arm = dh_arm(UR10E)
    q = np.array([0.3, -0.9, 1.1, 0.4, -0.8, 0.2])
    found = wrist_centre(arm, q)
    least = np.sum(distances(arm, q, found.point_m)[3:] ** 2)
    for step in 1e-3 * np.vstack([np.eye(3), -np.eye(3)]):
        assert np.sum(distances(arm, q, found.point_m + step)[3:] ** 2) > least


@pytest.mark.parametrize(
    ("rows", "elbow"), [(UR10E, 2), (SEVEN, 3), (FIVE, 2)], ids=["six", "seven", "five"]
)
def test_the_plane_brings_the_wrist_where_it_is_wanted(rows, elbow):
    arm = dh_arm(rows)
    plane = meridian_plane(arm)
    assert plane.elbow == elbow
    wanted = plane.shoulder_m + 0.6 * plane.reach_m * np.exp(0.4j)
    for side in ELBOWS:
        q = plane.joints_at(wanted.real, wanted.imag, side)
        at = wrist_centre(arm, q).point_m
        reached = complex(at @ plane.horizontal, at @ plane.vertical)
        assert reached == pytest.approx(wanted, abs=1e-12)


def test_a_seven_axis_arm_is_mapped_and_the_turning_joint_is_told():
    arm = dh_arm(SEVEN)
    n = len(arm.joints)
    elastic = ElasticJoints(
        joints=tuple(range(n)),
        stiffness_n_m_per_rad=np.full(n, 1e4),
        damping_n_m_s_per_rad=np.full(n, 2.0),
    )
    mapped = map_frequencies(arm, elastic, n_lines=9)
    assert np.isfinite(mapped.f_hz).any()
    assert any("axis 3 can turn the elbow out of the plane" in note for note in mapped.notes)


@pytest.mark.parametrize(
    ("arm", "words"),
    [
        (chain_arm(4), "has 4 joints"),
        (dh_arm(SCARA), "is not horizontal"),
    ],
    ids=["four", "scara"],
)
def test_where_maps_make_no_sense_it_is_said_what_to_use_instead(arm, words):
    with pytest.raises(ArmError, match=words) as caught:
        meridian_plane(arm)
    assert "statistics over random postures" in str(caught.value)
