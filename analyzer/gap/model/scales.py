"""How much an arm's joints give way, and how long the arm is: what its parts are built for."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.priors import LEAST_CARRIED, UNTOLD
from armodal.protocols.arrays import frozen_array

__all__ = ["compliance", "doubt", "foot_m", "reach_m", "scale", "steps_m"]

Array = npt.NDArray[np.float64]


def compliance(superset: Superset) -> float:
    """Return the arm's own compliance, rad/(N m): the geometric mean of its first three drives'."""
    k = [j.stiffness.value for j in superset.arm.joints if j.stiffness is not None][:3]
    return float(np.exp(-np.mean(np.log(k))))


def reach_m(superset: Superset) -> float:
    """Return the length of an arm's chain, from its foot to its last joint.

    Of an arm whose joints are all in one place, how far its bodies and points reach.
    """
    arm = superset.arm
    places = [*(j.link.center_m for j in arm.joints), *(point.position_m for point in arm.points)]
    return sum(steps_m(superset)) or max(float(np.linalg.norm(place)) for place in places)


def steps_m(superset: Superset) -> tuple[float, ...]:
    """Return the length of each step of the chain: from the foot to the first joint, and so on."""
    steps = [joint.T_parent_joint[:3, 3] for joint in superset.arm.joints]
    steps[0] = steps[0] - foot_m(superset)
    return tuple(float(np.linalg.norm(step)) for step in steps)


@lru_cache(maxsize=16)
def foot_m(superset: Superset) -> Array:
    """Return (3,) where the arm stands on the level of its base's frame, in that frame.

    Below its first axis where that passes nearest to the origin, which a URDF may have anywhere in
    a room.
    """
    first = superset.arm.joints[0]
    along, at = first.T_parent_joint[:3, :3] @ first.axis, first.T_parent_joint[:3, 3]
    nearest = at - along * (along @ at)
    return frozen_array([*nearest[:2], 0.0], np.float64)


def scale(superset: Superset, joint: int) -> float:
    """Return what a joint's drive gives way by, or would, rad/(N m).

    Its own where it has a spring; else as the arm's joints go with the weight they carry: drives,
    bearings and castings are all chosen for that.
    """
    return _scales(superset)[joint]


def doubt(superset: Superset, joint: int) -> float:
    """Return how many times softer than its `scale` a joint's drive may be: 1 where it is told."""
    return UNTOLD if superset.arm.joints[joint].stiffness is None else 1.0


@lru_cache(maxsize=16)
def _scales(superset: Superset) -> tuple[float, ...]:
    joints = superset.arm.joints
    steps = [float(np.linalg.norm(j.T_parent_joint[:3, 3])) for j in joints]
    out = [float(np.linalg.norm(j.link.center_m)) for j in joints]
    carried = [
        sum(
            joints[j].link.mass_kg * (sum(steps[i + 1 : j + 1]) + out[j])
            for j in range(i, len(joints))
        )
        for i in range(len(joints))
    ]
    # A wrist without a tool carries next to nothing, and is built for the tool.
    carried = [max(w, LEAST_CARRIED * max(carried)) for w in carried]
    own = [None if j.stiffness is None else 1.0 / j.stiffness.value for j in joints]
    level = np.mean(
        [np.log(c * w) for c, w in zip(own, carried, strict=True) if c is not None] or [0.0]
    )
    return tuple(
        float(np.exp(level)) / w if c is None else c for c, w in zip(own, carried, strict=True)
    )
