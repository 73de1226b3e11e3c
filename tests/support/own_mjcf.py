"""Somebody's MJCF of an arm: other frames, masses of their own, an actuator, a comment."""

import mujoco
import numpy as np


def own_mjcf(arm, *, order=None, names=True, extra=""):
    """Somebody's MJCF of an arm: every body's frame turned by 90 degrees, masses of their own."""
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    text, closing, before = "", "", np.eye(3)
    joints = [arm.joints[i] for i in order or range(len(arm.joints))]
    for joint in joints:
        R = before.T @ joint.T_parent_joint[:3, :3] @ turn
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, R.reshape(9))
        pos = before.T @ joint.T_parent_joint[:3, 3]
        named = f'name="{joint.name}"' if names else ""
        text += (
            f'<body name="{joint.link.name}" pos="{_list(pos)}" quat="{_list(quat)}">'
            f'<joint {named} axis="{_list(turn.T @ joint.axis)}" range="-3 3"/>'
            f'<geom name="skin {joint.link.name}" type="sphere" size="0.05" mass="1"/>'
        )
        closing += "</body>"
        before = turn
    return (
        '<mujoco model="mine"><compiler angle="radian"/><!-- kept -->'
        f'<worldbody><body name="stand" pos="0.3 0 0.2">{text}{closing}</body></worldbody>'
        f'<actuator><motor name="drive" joint="{joints[1].name if names else ""}"/></actuator>'
        f"{extra}</mujoco>"
    )


def _list(values):
    return " ".join(str(float(v)) for v in values)
