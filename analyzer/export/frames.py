"""How the bodies of somebody's MJCF stand to the links of an arm file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["BodyFrames", "body_frames"]

Array = npt.NDArray[np.float64]

_OFF_DEG, _OFF_M = 0.2, 1e-3  # of an axis: rounding of files, not another arm
_SEED = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyFrames:
    """Poses of link frames in the bodies' own."""

    T_body_link: tuple[Array, ...]  # (4, 4) each
    T_body_base: Array  # (4, 4) of the base in the body before the first link's


def body_frames(arm: Arm, mujoco: Any, model: Any, bodies: list[str], before: str) -> BodyFrames:
    """Find the frames, and refuse a file whose joints are not the arm's.

    Parameters
    ----------
    bodies
        That of each joint of the arm.
    before
        The body the first of them hangs on; "world" for the world.

    Raises
    ------
    ArmError
        If an axis is elsewhere or turns the other way; the worst is named.
    """
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    drawn = low + (high - low) * np.random.default_rng(_SEED).random(len(low))
    superset = Superset(arm)
    rest = [(q, superset.posture(q).T_base_link) for q in (np.zeros(len(low)), drawn)]
    seen = [_poses(arm, mujoco, model, q, bodies, before) for q, _ in rest]
    best: tuple[float, str, Array] | None = None
    for T_world_base in (seen[0][1], np.eye(4)):
        off = max(
            _worst(arm, T_world_base, T_base_link, axes)
            for (_, T_base_link), (_, _, axes) in zip(rest, seen, strict=True)
        )
        if best is None or off[0] < best[0]:
            best = (*off, T_world_base)
    if best is None or best[0] > 1.0:
        words = "" if best is None else best[1]
        raise ArmError(
            f"wanted an MJCF whose joints lie as those of arm '{arm.name}' do, got {words}; give "
            "the model of this arm, with the same zero of every joint"
        )
    T_world_base = best[2]
    return BodyFrames(
        T_body_link=tuple(
            np.linalg.inv(body) @ T_world_base @ link
            for body, link in zip(seen[0][0], rest[0][1], strict=True)
        ),
        T_body_base=np.linalg.inv(seen[0][1]) @ T_world_base,
    )


def _poses(
    arm: Arm, mujoco: Any, model: Any, q: Array, bodies: list[str], before: str
) -> tuple[list[Array], Array, list[tuple[Array, Array]]]:
    """Poses of bodies in the world, that of the body before, and each joint's place and axis."""
    data = mujoco.MjData(model)
    for joint, angle in zip(arm.joints, q, strict=True):
        data.qpos[model.joint(joint.name).qposadr[0]] = angle
    mujoco.mj_kinematics(model, data)
    axes = []
    for joint in arm.joints:
        at = model.joint(joint.name).id
        axes.append((data.xanchor[at].copy(), data.xaxis[at].copy()))
    return [_pose(data, name) for name in bodies], _pose(data, before), axes


def _pose(data: Any, body: str) -> Array:
    T = np.eye(4)
    T[:3, :3] = data.body(body).xmat.reshape(3, 3)
    T[:3, 3] = data.body(body).xpos
    return T


def _worst(
    arm: Arm, T_world_base: Array, T_base_link: Array, axes: list[tuple[Array, Array]]
) -> tuple[float, str]:
    """How far an axis is off, in parts of what is allowed, and in words."""
    found = []
    for joint, T, (anchor, axis) in zip(arm.joints, T_base_link, axes, strict=True):
        own = T_world_base @ T
        direction = own[:3, :3] @ joint.axis
        angle = float(np.rad2deg(np.arccos(np.clip(direction @ axis, -1.0, 1.0))))
        away = float(np.linalg.norm(np.cross(anchor - own[:3, 3], axis)))
        words = f"the axis of {joint.name} off by {angle:.1f} deg and {1e3 * away:.1f} mm"
        found.append((max(angle / _OFF_DEG, away / _OFF_M), words))
    return max(found)
