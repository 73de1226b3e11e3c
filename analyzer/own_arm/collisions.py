"""Which postures an arm can stand in: no body in another, none in what is kept free.

Every body is the convex hulls of its shapes, which hold the shapes: a posture whose hulls are apart
is free for the meshes. Hulls are checked by coal through pinocchio, with a margin between them.
Neighbours on a joint are not checked. Where two other bodies' hulls are never apart (a wrist's),
their triangles are checked; where these meet always too, the two bodies touch by their making, and
the pair is left out and named.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.floor import reach_of
from armodal.analyzer.own_arm.meshes import coal
from armodal.analyzer.own_arm.points import FOOT_M, probe
from armodal.analyzer.own_arm.solids import hull_solid, touches, triangle_solid
from armodal.protocols.arm.records import Arm, KeepOut, Point

__all__ = ["Collisions"]

Array = npt.NDArray[np.float64]

MARGIN_OF_REACH = 0.01  # between hulls: 10 mm an arm of 1 m, for cables and the posture's tolerance
STEP_RAD = 0.05  # of the fastest joint along a path: 3 degrees
HAND_M = 0.15  # free before a face for a sensor with its cable, or for a hammer's head
_N_ALWAYS = 200  # random postures that tell what always touches
_ALWAYS = 0.97
_N_SAMPLED = 16


class Collisions:
    """An arm's bodies and what it has to stay out of.

    Parameters
    ----------
    bodies
        Base first, then one for each of the arm's joints.
    keep_outs
        Boxes in the base's frame. The base and the link on it may stand in them.

    Raises
    ------
    MissingPackageError
        If pinocchio is not installed.
    """

    def __init__(
        self, arm: Arm, bodies: Sequence[ArmBody], keep_outs: Sequence[KeepOut] = ()
    ) -> None:
        self._pin: Any = import_module("pinocchio")
        self._arm, self._bodies, self._keep_outs = arm, tuple(bodies), tuple(keep_outs)
        self._probes: dict[tuple[bytes, bytes], tuple[object, Array]] = {}
        self.margin_m = MARGIN_OF_REACH * reach_of(arm)
        self._model = self._kinematics()
        self._data = self._model.createData()
        self._solids = [triangle_solid(shell) for body in bodies for shell in body.shells]
        pairs = [(i, j) for i in range(len(bodies)) for j in range(i + 2, len(bodies))]
        pairs += [(-1 - k, j) for k in range(len(keep_outs)) for j in range(2, len(bodies))]
        self._hulls = self._geometry(pairs, exact=False)
        always = self._always(self._hulls)
        self._exact = self._geometry(always, exact=True)
        self.touching = tuple(self._always(self._exact))
        self._hulls = self._geometry([pair for pair in pairs if pair not in always], exact=False)
        self._exact = self._geometry(
            [pair for pair in always if pair not in self.touching], exact=True
        )

    def name(self, number: int) -> str:
        """Name of a body, or of a keep-out (below 0)."""
        return self._bodies[number].name if number >= 0 else self._keep_outs[-1 - number].name

    def clear(self, joints_rad: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Tell which postures (n, n_joints) are free, (n,)."""
        q = np.atleast_2d(np.asarray(joints_rad, dtype=np.float64))
        return np.array([self._is_clear(one) for one in q], dtype=bool)

    def met(self, joints_rad: npt.ArrayLike) -> tuple[str, ...]:
        """Tell which bodies meet in a posture, as texts; empty if it is free."""
        q = np.asarray(joints_rad, dtype=np.float64)
        found = []
        for geometry, data, named in (self._hulls, self._exact):
            if named:
                self._pin.computeCollisions(self._model, self._data, geometry, data, q, False)
                found += [
                    f"{self.name(a)} and {self.name(b)}"
                    for (a, b), result in zip(named, data.collisionResults, strict=True)
                    if result.isCollision()
                ]
        return tuple(dict.fromkeys(found))

    def path_clear(self, start_rad: Array, end_rad: Array) -> bool:
        """Whether the straight path in the joints' angles is free."""
        steps = int(np.ceil(np.abs(end_rad - start_rad).max() / STEP_RAD))
        parts = np.linspace(0.0, 1.0, max(steps, 1) + 1)[:, None]
        # The middle first: a path that is not free mostly is not there.
        order = np.argsort(np.abs(parts[:, 0] - 0.5), kind="stable")
        return all(
            self._is_clear(start_rad + part * (end_rad - start_rad)) for part in parts[order]
        )

    def reachable(self, joints_rad: Array, points: Sequence[Point]) -> frozenset[str]:
        """Ids of points before whose face a hand and a hammer have room in a posture."""
        poses = self._poses(joints_rad)
        names = {body.name: i for i, body in enumerate(self._bodies)} | {"base": 0}
        found = set()
        for point in points:
            own = names[point.link]
            rod, T = self._probe(point)
            T_base_rod = poses[own] @ T
            if not self._hits(rod, T_base_rod, own, poses):
                found.add(point.id)
        return frozenset(found)

    def often_free(self, body: int, place_m: Array, normal: Array) -> bool:
        """Whether a hand reaches a place of a body in half of the free postures or more."""
        rod, T = probe(place_m, normal, free_m=HAND_M)
        poses = self._sampled
        each_hit = (self._hits(rod, each[body] @ T, body, each) for each in poses)
        half = len(poses) // 2
        hit = free = 0
        while hit <= half and free < len(poses) - half:  # until it is settled
            if next(each_hit):
                hit += 1
            else:
                free += 1
        return hit <= half

    def _probe(self, point: Point) -> tuple[object, Array]:
        """The hand before a point, made once: postures ask for it by thousands."""
        key = (point.position_m.tobytes(), point.R_link_sensor.tobytes())
        if key not in self._probes:
            made = probe(point.position_m, point.R_link_sensor[:, 2], free_m=HAND_M)
            self._probes[key] = made
        return self._probes[key]

    @cached_property
    def _balls(self) -> tuple[npt.NDArray[np.int64], Array, Array]:
        """Balls round the shells: of which body, middle in its frame (n, 3), radius (n,)."""
        shells = [
            (i, shell.vertices_m) for i, body in enumerate(self._bodies) for shell in body.shells
        ]
        middles = np.array([0.5 * (v.min(axis=0) + v.max(axis=0)) for _, v in shells])
        radii = np.array(
            [np.linalg.norm(v - m, axis=1).max() for (_, v), m in zip(shells, middles, strict=True)]
        )
        return np.array([i for i, _ in shells]), middles, radii

    @cached_property
    def _sampled(self) -> list[Array]:
        """Poses of all bodies in some free postures; in any where none was free."""
        rng = np.random.default_rng(1)
        low, high = np.array([joint.range_rad for joint in self._arm.joints]).T
        q = rng.uniform(low, high, size=(_N_ALWAYS, len(low)))
        free = q[self.clear(q)]
        return [self._poses(one) for one in (free if len(free) else q)[:_N_SAMPLED]]

    def _poses(self, joints_rad: Array) -> Array:
        """(n_bodies, 4, 4), in base."""
        self._pin.forwardKinematics(self._model, self._data, np.asarray(joints_rad, dtype=float))
        return np.array([self._data.oMi[i].homogeneous for i in range(len(self._bodies))])

    def _hits(self, rod: Any, T_base_rod: Array, own: int, poses: Array) -> bool:
        """Whether a hand's rod meets a body but its own, or what is kept free."""
        at, middles, radii = self._balls
        T = poses[at]
        away = np.einsum("sij,sj->si", T[:, :3, :3], middles) + T[:, :3, 3] - T_base_rod[:3, 3]
        near = np.einsum("si,si->s", away, away) < (radii + 0.5 * HAND_M + FOOT_M) ** 2
        for i in np.flatnonzero(near & (at != own)):
            if touches(self._solids[i], rod, T_base_rod, T[i]):
                return True
        for box in self._keep_outs:
            size, middle = _box(box)
            T = T_base_rod.copy()
            T[:3, 3] -= middle
            if touches(coal().Box(*size), rod, T):
                return True
        return False

    def _is_clear(self, q: Array) -> bool:
        for geometry, data, named in (self._hulls, self._exact):
            if named and self._pin.computeCollisions(
                self._model, self._data, geometry, data, q, True
            ):
                return False
        return True

    def _kinematics(self) -> Any:
        pin = self._pin
        model = pin.Model()
        parent = 0
        for joint in self._arm.joints:
            T = joint.T_parent_joint
            parent = model.addJoint(
                parent,
                pin.JointModelRevoluteUnaligned(np.asarray(joint.axis, dtype=float)),
                pin.SE3(np.array(T[:3, :3]), np.array(T[:3, 3])),
                joint.name,
            )
        return model

    def _geometry(
        self, pairs: Collection[tuple[int, int]], *, exact: bool
    ) -> tuple[Any, Any, list[tuple[int, int]]]:
        """Pinocchio's shapes and checks of pairs of bodies, and whose each check is."""
        pin, geometry = self._pin, self._pin.GeometryModel()
        shapes: dict[int, list[int]] = {}
        for number in sorted({number for pair in pairs for number in pair}):
            if number < 0:
                size, middle = _box(self._keep_outs[-1 - number])
                solids, place = [coal().Box(*size)], pin.SE3(np.eye(3), middle)
            else:
                solids = [
                    triangle_solid(shell) if exact else hull_solid(shell)
                    for shell in self._bodies[number].shells
                ]
                place = pin.SE3.Identity()
            shapes[number] = [
                geometry.addGeometryObject(
                    pin.GeometryObject(f"{number} {i}", max(number, 0), place, solid)
                )
                for i, solid in enumerate(solids)
            ]
        named = []
        for a, b in pairs:
            for first in shapes[a]:
                for second in shapes[b]:
                    geometry.addCollisionPair(pin.CollisionPair(first, second))
                    named.append((a, b))
        data = pin.GeometryData(geometry)
        if not exact:
            for request in data.collisionRequests:
                request.security_margin = self.margin_m
        return geometry, data, named

    def _always(self, checks: tuple[Any, Any, list[tuple[int, int]]]) -> list[tuple[int, int]]:
        """Pairs of bodies that meet in nearly all postures."""
        geometry, data, named = checks
        if not named:
            return []
        rng = np.random.default_rng(0)
        low, high = np.array([joint.range_rad for joint in self._arm.joints]).T
        met: dict[tuple[int, int], int] = dict.fromkeys(named, 0)
        for q in rng.uniform(low, high, size=(_N_ALWAYS, len(low))):
            self._pin.computeCollisions(self._model, self._data, geometry, data, q, False)
            hit = {
                pair
                for pair, result in zip(named, data.collisionResults, strict=True)
                if result.isCollision()
            }
            for pair in hit:
                met[pair] += 1
        return [pair for pair, count in met.items() if count >= _ALWAYS * _N_ALWAYS]


def _box(keep_out: KeepOut) -> tuple[Array, Array]:
    low, high = keep_out.low_m, keep_out.high_m
    return high - low, 0.5 * (low + high)
