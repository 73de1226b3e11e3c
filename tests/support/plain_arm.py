"""An arm's kinematics, inertia and energy written out from its link data alone.

Nothing here comes from `analyzer`: these are the second way to the same numbers.
"""

import numpy as np
from scipy.spatial.transform import Rotation

# The postures of file 000, Table 2, in degrees.
TESTS_DEG = ((-25, 90, 0, 0, 90, 0), (-25, 0, 98, 0, -9, 0), (-25, -80, 155, 2, -75, 0))


def turned(axis, angle_rad, through=(0.0, 0.0, 0.0)):
    """Return the (4, 4) motion that turns about a line by an angle."""
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec(angle_rad * np.asarray(axis)).as_matrix()
    T[:3, 3] = np.asarray(through) - T[:3, :3] @ np.asarray(through)
    return T


def link_poses(arm, joints_rad, axes=(), turns=()):
    """Return (n_links, 4, 4) poses; `axes` are (link, direction, point) in the link's frame."""
    T, poses = np.eye(4), []
    for i, joint in enumerate(arm.joints):
        T = T @ joint.T_parent_joint @ turned(joint.axis, joints_rad[i])
        for (link, direction, point), turn in zip(axes, turns, strict=True):
            if link == i:
                T = T @ turned(direction, turn, point)
        poses.append(T)
    return np.array(poses)


def point_pose(arm, point_id, joints_rad, axes=(), turns=()):
    """Return the position in base and the rotation of a test point's sensor."""
    point = arm.point(point_id)
    T = np.eye(4)
    if point.link != "base":
        number = [joint.link.name for joint in arm.joints].index(point.link)
        T = link_poses(arm, joints_rad, axes, turns)[number]
    return T[:3, :3] @ point.position_m + T[:3, 3], T[:3, :3] @ point.R_link_sensor


def potential_energy_j(arm, joints_rad, axes=(), turns=()):
    """Return the potential energy of all links in gravity."""
    poses = link_poses(arm, joints_rad, axes, turns)
    return -sum(
        joint.link.mass_kg * arm.gravity_m_s2 @ (T[:3, :3] @ joint.link.center_m + T[:3, 3])
        for joint, T in zip(arm.joints, poses, strict=True)
    )


def mass_matrix(arm, joints_rad, axes=()):
    """Return M by file 002, Eqs. (4) and (5): first all joints, then the axes as more hinges."""
    poses = link_poses(arm, joints_rad, axes, [0.0] * len(axes))
    hinges = [
        (i, T[:3, :3] @ joint.axis, T[:3, 3])
        for i, (joint, T) in enumerate(zip(arm.joints, poses, strict=True))
    ]
    for link, direction, point in axes:
        T = poses[link]
        hinges.append((link, T[:3, :3] @ direction, T[:3, :3] @ point + T[:3, 3]))
    M = np.zeros((len(hinges), len(hinges)))
    for i, (joint, T) in enumerate(zip(arm.joints, poses, strict=True)):
        center = T[:3, :3] @ joint.link.center_m + T[:3, 3]
        inertia = T[:3, :3] @ joint.link.inertia_kg_m2 @ T[:3, :3].T
        linear = [
            np.cross(z, center - at) if first <= i else np.zeros(3) for first, z, at in hinges
        ]
        angular = [z if first <= i else np.zeros(3) for first, z, _ in hinges]
        Jp, Jo = np.transpose(linear), np.transpose(angular)
        M += joint.link.mass_kg * Jp.T @ Jp + Jo.T @ inertia @ Jo
    return M


def second_difference(f, n, h):
    """Return the (n, n) matrix of central second differences of a function of n numbers at 0."""
    H = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            a, b = h * np.eye(n)[i], h * np.eye(n)[j]
            H[i, j] = (f(a + b) - f(a - b) - f(b - a) + f(-a - b)) / (4 * h * h)
    return H
