"""The arm in a robot description: one chain of moving joints, everything else held or left out.

Fingers, grippers, joints that mimic others, quills and linear axes are held: what they carry moves
with the link that carries them. What hangs beyond the tip, and other arms on the same base, are
left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.robot.records import MOVING, Robot, RobotJoint, RobotLink
from armodal.protocols.robot.remarks import Remarks, few
from armodal.protocols.robot.tip import found_tip
from armodal.protocols.robot.tree import joints_below, path_to

__all__ = ["Body", "CutChain", "Part", "cut_chain"]

Array = npt.NDArray[np.float64]

CONTINUOUS_DEG = 180.0  # a continuous joint turns on; half a turn each way shows all its postures
MOST_JOINTS = 9


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A link of the description, held fast in a body."""

    link: RobotLink
    T_body_link: Array  # (4, 4)


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """What moves as one; the first part is the link that its joint moves."""

    joint: RobotJoint | None  # None of the base
    T_parent_joint: Array  # (4, 4) in the body before
    range_rad: tuple[float, float]
    parts: tuple[Part, ...]

    @property
    def name(self) -> str:
        """Name of the link in whose frame the body stands."""
        return self.parts[0].link.name


@dataclass(frozen=True, slots=True, kw_only=True)
class CutChain:
    """The base and, from there outwards, one body for every moving joint."""

    name: str
    base: Body
    bodies: tuple[Body, ...]
    tip: str


def cut_chain(robot: Robot, said: Remarks, *, tip: str | None = None) -> CutChain | None:
    """Find the arm, hold what is not part of it, and say all of this.

    Parameters
    ----------
    tip
        The last link that belongs to the arm; found where none is given.

    Returns
    -------
    CutChain or None
        None after a fault that leaves no chain to look at.
    """
    root = _root(robot, said)
    if root is None:
        return None
    if tip is not None and tip not in robot.links:
        said.fault("tip", f"wanted a link of the file, got {tip!r}; it has {few(robot.links)}")
        return None
    chosen = tip or found_tip(robot, root, said)
    if chosen is None:
        return None
    path = path_to(robot, root, chosen)
    moving = [joint for joint in path if joint.kind in MOVING and not joint.mimics]
    if not moving:
        said.fault("joints", f"wanted a revolute joint between {root} and {chosen}, found none")
        return None
    if len(moving) > MOST_JOINTS:
        said.fault("joints", f"wanted at most {MOST_JOINTS} moving joints, found {len(moving)}")
        return None
    cutter = _Cutter(robot, said, moving, beyond=chosen if tip else None)
    base = cutter.body(None, root, np.eye(4))
    bodies = []
    carrier = base
    for joint in moving:
        T = cutter.places[joint.name]
        carrier = cutter.body(joint, joint.child, T)
        bodies.append(carrier)
    _say_left_out(robot, root, {p.link.name for b in (base, *bodies) for p in b.parts}, said)
    return CutChain(name=robot.name, base=base, bodies=tuple(bodies), tip=chosen)


def _root(robot: Robot, said: Remarks) -> str | None:
    """The link without a parent; None where links and joints are no tree."""
    parents: dict[str, str] = {}
    tree = True
    for joint in robot.joints:
        if joint.child in parents:
            said.fault(f"link {joint.child}", "wanted one parent, got two; cut the loop")
            tree = False
        parents[joint.child] = joint.parent
    roots = [name for name in robot.links if name not in parents]
    if len(roots) != 1:
        said.fault("links", f"wanted one root, got {len(roots)}{': ' if roots else ''}{few(roots)}")
        return None
    reached = set(roots) | {joint.child for joint in joints_below(robot, roots[0])}
    if len(reached) < len(robot.links):
        loop = [name for name in robot.links if name not in reached]
        said.fault("links", f"wanted every link on the tree, got a loop of {few(loop)}")
        tree = False
    return roots[0] if tree else None


class _Cutter:
    """Joins what is held to the body that carries it; `places` fills with the next joints."""

    def __init__(
        self, robot: Robot, said: Remarks, moving: list[RobotJoint], beyond: str | None
    ) -> None:
        self._robot, self._said, self._beyond = robot, said, beyond
        self._moving = {joint.name for joint in moving}
        self._root = moving[0].parent
        self.places: dict[str, Array] = {}

    def body(self, joint: RobotJoint | None, first: str, T_parent_joint: Array) -> Body:
        parts = []
        waiting = [(first, np.eye(4))]
        while waiting:
            name, T = waiting.pop(0)
            parts.append(Part(link=self._robot.links[name], T_body_link=T))
            if name == self._beyond:
                continue
            for child in self._robot.children(name):
                T_child = T @ child.T_parent_joint
                if child.name in self._moving:
                    self.places[child.name] = T_child
                elif child.kind == "fixed":
                    waiting.append((child.child, T_child))
                elif joint is None and self._holds_an_arm(child):
                    self._said.note(f"joint {child.name}", "left out with what it carries")
                else:
                    waiting.append((child.child, T_child @ self._held(child)))
        return Body(
            joint=joint,
            T_parent_joint=T_parent_joint,
            range_rad=(0.0, 0.0) if joint is None else self._range(joint),
            parts=tuple(parts),
        )

    def _holds_an_arm(self, joint: RobotJoint) -> bool:
        """Whether a joint of the base carries something else than this arm."""
        below = {joint.name} | {other.name for other in joints_below(self._robot, joint.child)}
        return not below & self._moving

    def _held(self, joint: RobotJoint) -> Array:
        """Where a joint is held: at zero, or in the middle of a range that leaves zero out."""
        where = 0.0
        if joint.range_rad is not None and not joint.range_rad[0] <= 0.0 <= joint.range_rad[1]:
            where = 0.5 * sum(joint.range_rad)
        why = f"mimics {joint.mimics}" if joint.mimics else f"is {joint.kind}"
        T = np.eye(4)
        if joint.kind == "prismatic":
            T[:3, 3] = where * joint.axis
            place = f"{1e3 * where:g} mm"
        elif joint.kind in MOVING:
            T[:3, :3] = _turned(joint.axis, where)
            place = f"{math.degrees(where):g} degrees"
            why = why if joint.mimics else "is beside the arm or behind its tip"
        else:
            place = "its origin"
        self._said.note(f"joint {joint.name}", f"{why}: held at {place}")
        return T

    def _range(self, joint: RobotJoint) -> tuple[float, float]:
        where = f"joint {joint.name}"
        half = math.radians(CONTINUOUS_DEG)
        if joint.kind == "continuous":
            self._said.guess(
                where, f"is continuous: range -{CONTINUOUS_DEG:g} to {CONTINUOUS_DEG:g} degrees"
            )
            return -half, half
        if joint.range_rad is None:
            self._said.fault(where, "wanted a limit, got none; add <limit lower upper>")
            return -half, half
        low, high = joint.range_rad
        if not low < high:
            self._said.fault(where, f"wanted limit lower < upper, got {low:g} and {high:g}")
            return -half, half
        if high - low > 8.0 * math.pi:
            self._said.fault(
                where,
                f"wanted limits in rad, got {low:g} to {high:g}, more than four turns; write rad",
            )
        return low, high


def _turned(axis: Array, angle: float) -> Array:
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K)
    return turned


def _say_left_out(robot: Robot, root: str, kept: set[str], said: Remarks) -> None:
    out = [name for name in robot.links if name not in kept and name != root]
    if out:
        said.note("links", f"left out, not of this arm or beyond its tip: {few(out)}")
