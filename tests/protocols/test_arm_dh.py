from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.arm.dh import dh_transform
from armodal.protocols.arm.urdf import rotation_rpy

# Adept Viper s650, modified rows alpha, a, theta offset, d, as the project's reference has them.
VIPER = [
    (0.0, 0.0, 0.0, 0.335),
    (-90.0, 0.075, 0.0, 0.0),
    (0.0, 0.270, 180.0, 0.0),
    (-90.0, 0.090, 0.0, 0.295),
    (90.0, 0.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0, 0.080),
]


def frames(angles_deg: list[float]) -> list[npt.NDArray[np.float64]]:
    T = np.eye(4)
    poses = []
    for (alpha, a, offset, d), angle in zip(VIPER, angles_deg, strict=True):
        T = T @ dh_transform(
            alpha_rad=math.radians(alpha),
            a_m=a,
            theta_offset_rad=math.radians(offset),
            d_m=d,
        )
        turn = np.eye(4)
        turn[:3, :3] = rotation_rpy(0.0, 0.0, math.radians(angle))
        T = T @ turn
        poses.append(T)
    return poses


angle = st.floats(-7.0, 7.0)
length = st.floats(-2.0, 2.0)


@given(angle, length, angle, length)
def test_a_row_is_the_product_of_its_four_motions(
    alpha: float, a: float, theta: float, d: float
) -> None:
    def pose(R: npt.NDArray[np.float64], p: list[float]) -> npt.NDArray[np.float64]:
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, p
        return T

    expected = (
        pose(rotation_rpy(alpha, 0, 0), [0, 0, 0])
        @ pose(np.eye(3), [a, 0, 0])
        @ pose(rotation_rpy(0, 0, theta), [0, 0, 0])
        @ pose(np.eye(3), [0, 0, d])
    )
    got = dh_transform(alpha_rad=alpha, a_m=a, theta_offset_rad=theta, d_m=d)
    # A few roundings of numbers up to 2.
    np.testing.assert_allclose(got, expected, atol=4e-15)


def test_the_viper_stretches_to_its_published_length() -> None:
    # Test 1 of paper 002: joints 0, 0, 90, 0, 0, 0, flange at x = 0.720 m, at link 2's height.
    flange = frames([0.0, 0.0, 90.0, 0.0, 0.0, 0.0])[-1][:3, 3]
    # 75 + 270 + 295 + 80 mm along x; the 90 mm offset is across.
    np.testing.assert_allclose(flange[[0, 1]], [0.720, 0.0], atol=1e-15)
    assert abs(abs(flange[2] - 0.335) - 0.090) < 1e-15


def test_the_viper_wrist_is_above_the_elbow_at_the_published_angle() -> None:
    # Test 2 of papers 001 and 002: joint 3 at 16.96 and 17 degrees; atan(90 / 295) = 16.97.
    q3 = math.degrees(math.atan2(90.0, 295.0))
    poses = frames([0.0, 0.0, q3, 0.0, 0.0, 0.0])
    elbow, wrist = poses[2][:3, 3], poses[4][:3, 3]
    distance = math.hypot(0.295, 0.090)
    np.testing.assert_allclose(wrist - elbow, [0.0, 0.0, distance], atol=1e-15)
