"""What an arm can do without moving its tool, and how stiff the tool stands meanwhile.

Seven joints leave one motion free where the tool's whole pose is kept; six leave one where the tool
may turn about its own axis, as a mill may. That motion is the null vector of the tool's Jacobian;
steps along it are brought back onto the pose by Newton's method (B. Siciliano and others, Robotics
(2009), sections 3.5 and 3.7).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.acting.along_path import best_along_path
from armodal.analyzer.acting.stiffness import ToolStiffness, tool_stiffness
from armodal.analyzer.corrected.batch import BatchedArm
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.errors import ArmError

__all__ = ["FreeAngle", "self_motion", "stiffest_angle"]

Array = npt.NDArray[np.float64]

STEP_RAD = 0.05  # of all joints together: stiffness is a smooth curve of it
_MOST_STEPS = 400  # each way: 20 rad, beyond a turn of every joint
_MOST_POSTURES = 2_000
_NEWTON = 4  # from 10^-3 by squares to rounding
_OFF = 1e-9  # m and rad that a pose may be off
_SAME = 1e-6  # relative: no stiffer, such as where the tool turns about the last joint's own axis
_SLOWEST_RAD = 2.0 * STEP_RAD  # that a joint may turn from pose to pose of any path
_ROUNDING = 1e-9  # rad
_SINGULAR = 1e-3  # of the largest singular value: there a second motion is free


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeAngle:
    """Of p tool poses, m samples of the free motion each; NaN beyond ranges."""

    angle_rad: Array  # (m,) way of all joints together from the given posture, both ways
    joints_rad: Array  # (p, m, n_joints)
    along_n_per_m: Array  # (p, m)
    given: ToolStiffness  # (p,) in the given postures
    best: ToolStiffness  # (p,) where it is stiffest
    best_angle_rad: Array  # (p,)
    together: ToolStiffness  # (p,) chosen for the whole path: no joint faster than the path's own
    together_angle_rad: Array  # (p,)


def stiffest_angle(
    ready: BatchedArm,
    joints_rad: Array,
    force_n: npt.ArrayLike,
    *,
    tool_m: npt.ArrayLike,
    spin: npt.ArrayLike | None = None,
) -> FreeAngle:
    """Look along the free motion of postures (p, n_joints) for where a force moves the tool least.

    Parameters
    ----------
    spin
        (3,) axis in the last link's frame about which the tool may turn; None: it keeps its pose.

    Raises
    ------
    ArmError
        If not exactly one motion is free, there are too many postures, or the force is none.
    """
    given = tool_stiffness(ready, joints_rad, force_n, tool_m=tool_m)
    q = self_motion(ready.batch, joints_rad, tool_m=tool_m, spin=spin)
    there = ~np.isnan(q).any(axis=-1)
    along = np.full(there.shape, np.nan)
    along[there] = tool_stiffness(ready, q[there], force_n, tool_m=tool_m).along_n_per_m
    middle = q.shape[1] // 2
    angle = STEP_RAD * (np.arange(q.shape[1]) - middle)
    stiffest = np.nanargmax(along, axis=1)
    gained = np.nanmax(along, axis=1) > (1.0 + _SAME) * along[:, middle]
    stiffest = np.where(gained, stiffest, middle)
    poses = np.arange(len(q))
    best = q[poses, stiffest]
    limit = np.abs(np.diff(given.joints_rad, axis=0)).max(axis=1, initial=_SLOWEST_RAD)
    chain = best_along_path(q, along, angle, STEP_RAD, limit + _ROUNDING)
    used = there.any(axis=0)
    return FreeAngle(
        angle_rad=angle[used],
        joints_rad=q[:, used],
        along_n_per_m=along[:, used],
        given=given,
        best=tool_stiffness(ready, best, force_n, tool_m=tool_m),
        best_angle_rad=angle[stiffest],
        together=tool_stiffness(ready, q[poses, chain], force_n, tool_m=tool_m),
        together_angle_rad=angle[chain],
    )


def self_motion(
    batch: ArmBatch,
    joints_rad: Array,
    *,
    tool_m: npt.ArrayLike,
    spin: npt.ArrayLike | None = None,
) -> Array:
    """Follow the free motion of postures (p, n_joints) both ways, within the joints' ranges.

    Returns
    -------
    (p, m, n_joints) float64
        The given posture in the middle; NaN beyond a range, a singular posture, or a whole round.

    Raises
    ------
    ArmError
        As `stiffest_angle`.
    """
    start = np.asarray(joints_rad, dtype=np.float64)
    rows = 6 if spin is None else 5
    if batch.n_joints != rows + 1:
        kept = "its pose" if spin is None else "its place and axis"
        raise ArmError(
            f"arm '{batch.arm.name}': wanted {rows + 1} joints, so that one motion is free while "
            f"the tool keeps {kept}, got {batch.n_joints}; seven joints keep the pose "
            "(--free-angle), six let the tool turn about an axis (--spin)"
        )
    if len(start) > _MOST_POSTURES:
        raise ArmError(
            f"wanted at most {_MOST_POSTURES} postures to look for the best angle of, got "
            f"{len(start)}; take every {-(-len(start) // _MOST_POSTURES)}th"
        )
    task = _Task(batch, np.asarray(tool_m, dtype=np.float64), spin, start)
    onward, closed = _followed(task, start, 1.0)
    back, _ = _followed(task, start, -1.0)
    for pose in np.flatnonzero(closed):  # half the round each way
        count = int((~np.isnan(onward[pose, :, 0])).sum())
        half = count // 2
        back[pose] = np.nan
        back[pose, : count - half] = onward[pose, half:count][::-1]
        onward[pose, half:] = np.nan
    return np.concatenate([back[:, ::-1], start[:, None], onward], axis=1)


def _followed(task: _Task, start: Array, sign: float) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Postures (p, steps, n), and which motions came back to where they began."""
    low, high = np.array([joint.range_rad for joint in task.batch.arm.joints]).T
    found = np.full((len(start), _MOST_STEPS, start.shape[1]), np.nan)
    closed = np.zeros(len(start), dtype=np.bool_)
    alive = np.arange(len(start))
    q = start
    before = sign * _upward(task.free(q)[0])
    for step in range(_MOST_STEPS):
        direction, regular = task.free(q)
        direction *= np.sign(np.einsum("pi,pi->p", direction, before))[:, None]
        q = task.corrected(q + STEP_RAD * direction, alive)
        off = np.abs(task.error(q, alive)).max(axis=1)
        turned = np.remainder(q - start[alive] + np.pi, 2.0 * np.pi) - np.pi
        again = (step > 1) & (np.linalg.norm(turned, axis=1) < STEP_RAD)
        closed[alive[again]] = True
        good = regular & (off < _OFF) & ((q >= low) & (q <= high)).all(axis=1) & ~again
        alive, q, before = alive[good], q[good], direction[good]
        if not len(alive):
            break
        found[alive, step] = q
    return found, closed


def _upward(direction: Array) -> Array:
    """Each with its largest part positive, so that both ways are told alike."""
    largest = np.abs(direction).argmax(axis=1)
    sign = np.sign(direction[np.arange(len(direction)), largest])
    return np.asarray(direction * sign[:, None])


class _Task:
    """The tool's poses that are kept."""

    def __init__(
        self, batch: ArmBatch, tool_m: Array, spin: npt.ArrayLike | None, start: Array
    ) -> None:
        self.batch = batch
        self._tool_m = tool_m
        self._axis = None
        if spin is not None:
            axis = np.asarray(spin, dtype=np.float64)
            self._axis = axis / np.linalg.norm(axis)
        self._rotation, self._place = self._pose(start)

    def _pose(self, q: Array) -> tuple[Array, Array]:
        """Rotations (p, 3, 3) and places (p, 3) of the tool."""
        last = self.batch.n_joints - 1
        place, *ends = self.batch.positions(
            q, last, self._tool_m + np.vstack([np.zeros(3), np.eye(3)])
        )
        rotation = np.stack([(end - place).T for end in ends], axis=2)
        return rotation, np.asarray(place.T)

    def _rows(self, rotation: Array) -> Array:
        """(p, 2 or 3, 3) directions about which the tool may not turn."""
        if self._axis is None:
            return np.asarray(np.broadcast_to(np.eye(3), rotation.shape))
        across = np.linalg.svd(self._axis[None])[2][1:]
        return np.asarray(np.einsum("pij,kj->pki", rotation, across))

    def _jacobian(self, q: Array) -> Array:
        # Of the joints alone, not of what effects let give way.
        every, _ = ArmBatch.unit_motions(self.batch, q, self._tool_m)
        J = np.moveaxis(every, 2, 0)
        rotation, _ = self._pose(q)
        return np.concatenate([J[:, :3], self._rows(rotation) @ J[:, 3:]], axis=1)

    def free(self, q: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Unit free motions (p, n), and whether there is only one."""
        _, sizes, right = np.linalg.svd(self._jacobian(q))
        return right[:, -1], sizes[:, -1] > _SINGULAR * sizes[:, 0]

    def error(self, q: Array, of: npt.NDArray[np.intp]) -> Array:
        """(p, rows) what is missing to the poses kept, m and rad."""
        rotation, place = self._pose(q)
        turn = 0.5 * np.cross(rotation, self._rotation[of], axis=1).sum(axis=2)
        if self._axis is not None:
            now, wanted = rotation @ self._axis, self._rotation[of] @ self._axis
            turn = np.cross(now, wanted)
        about = np.einsum("pki,pi->pk", self._rows(rotation), turn)
        return np.concatenate([self._place[of] - place, about], axis=1)

    def corrected(self, q: Array, of: npt.NDArray[np.intp]) -> Array:
        """Return postures brought back onto the poses kept."""
        for _ in range(_NEWTON):
            J = self._jacobian(q)
            q = q + np.asarray(np.einsum("pij,pj->pi", np.linalg.pinv(J), self.error(q, of)))
        return q
