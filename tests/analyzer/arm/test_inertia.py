"""Moments of inertia about the joints against file 002, Eqs. (8) and (9), and file 000."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.plain_arm import TESTS_DEG, link_poses

from armodal.analyzer.arm.inertia import moments_about_joints

angles = st.lists(st.floats(-np.pi, np.pi), min_size=6, max_size=6).map(np.array)


def equation_eight(arm, poses, i, inertia_of):
    """Moment about joint i: the sum of 002 Eq. (8) in the frame of link i, P_ji by Eq. (9).

    `inertia_of(i, j)` names the link whose inertia stands inside the sum.
    """
    total = np.zeros((3, 3))
    for j in range(i, len(arm.joints)):
        link = arm.joints[j].link
        T = np.linalg.inv(poses[i]) @ poses[j]
        R = T[:3, :3]
        x, y, z = R @ link.center_m + T[:3, 3]
        P = np.array(
            [
                [y**2 + z**2, -x * y, -x * z],
                [-y * x, x**2 + z**2, -y * z],
                [-z * x, -z * y, x**2 + y**2],
            ]
        )
        other = arm.joints[inertia_of(i, j)].link
        total += R @ other.inertia_kg_m2 @ R.T + link.mass_kg * P
    axis = arm.joints[i].axis
    return axis @ total @ axis


@settings(max_examples=25)
@given(angles)
def test_moments_are_those_of_equation_eight_with_the_moving_links_inertia(arm, q):
    poses = link_poses(arm, q)
    by_hand = [equation_eight(arm, poses, i, lambda _, j: j) for i in range(6)]
    # Two orders of the same products: a few hundred roundings.
    np.testing.assert_allclose(moments_about_joints(arm, poses), by_hand, rtol=1e-12)


@pytest.mark.parametrize(
    ("test", "stated", "k_n_m_per_rad", "f_hz"),
    [(0, 2.374, 20789, 14.8), (1, 1.695, 24307, 19.2), (2, 0.357, 21243, 38.8)],
)
def test_the_arm_has_the_inertias_of_file_000(arm, test, stated, k_n_m_per_rad, f_hz):
    q = np.deg2rad(TESTS_DEG[test])
    found = moments_about_joints(arm, link_poses(arm, q))[test]
    assert found == pytest.approx(stated, abs=5e-4)  # half of the last digit stated
    # The printed stiffness and frequency, by Eq. (1); one density was fitted to all three.
    assert found == pytest.approx(k_n_m_per_rad / (2 * np.pi * f_hz) ** 2, rel=0.016)
