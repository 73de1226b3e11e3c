"""The way from posture to posture: straight in the joints' angles, else by stops between.

Stops are found on a lazy probabilistic roadmap: random free postures, each tied to its nearest, of
which the shortest way is checked, and what is not free is cut, until a way is free (R. Bohlin,
L. Kavraki, IEEE Int. Conf. Robotics and Automation (2000) 521).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.planning.room import Room
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.arm.records import Arm

__all__ = ["Leg", "route", "wound"]

Array = npt.NDArray[np.float64]

N_STOPS = 400  # random postures of the roadmap
N_TIED = 12  # nearest ones that each is tied to
MOST_TRIES = 300  # ways looked at for one leg


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """From one posture of the plan to the next, all joints at once in straight lines.

    `stops_rad` are postures to go by; None where no free way was found.
    """

    stops_rad: tuple[Array, ...] | None


def wound(arm: Arm, joints_rad: Array, near_rad: Array) -> Array:
    """The same posture with whole turns added, within the ranges, to come near another one."""
    q = joints_rad.copy()
    for i, joint in enumerate(arm.joints):
        low, high = joint.range_rad
        turns = 2.0 * np.pi * np.arange(-4, 5) + joints_rad[i]
        turns = turns[(turns >= low) & (turns <= high)]
        if len(turns):
            q[i] = turns[np.argmin(np.abs(turns - near_rad[i]))]
    return q


def route(
    arm: Arm, postures_rad: Sequence[Array], room: Room, rng: np.random.Generator
) -> tuple[Leg, ...]:
    """The legs between postures in the order given, one fewer than postures."""
    legs = []
    stops: Array | None = None
    for start, end in pairwise(postures_rad):
        if room.path_clear(start, end):
            legs.append(Leg(stops_rad=()))
            continue
        if stops is None:
            stops = random_postures(arm, N_STOPS, rng)
            stops = stops[room.free(stops)]
        legs.append(Leg(stops_rad=_by_stops(start, end, stops, room)))
    return tuple(legs)


def _by_stops(start: Array, end: Array, stops: Array, room: Room) -> tuple[Array, ...] | None:
    nodes = np.concatenate([[start, end], stops])
    length = np.abs(nodes[:, None] - nodes[None]).max(axis=2)
    nearest = np.argsort(length, axis=1)[:, 1 : N_TIED + 1]
    tied = np.zeros_like(length)
    rows = np.repeat(np.arange(len(nodes)), nearest.shape[1])
    tied[rows, nearest.ravel()] = length[rows, nearest.ravel()]
    tied = np.maximum(tied, tied.T)
    tied[0, 1] = tied[1, 0] = 0.0  # the straight way is not free
    known: set[tuple[int, int]] = set()
    for _ in range(MOST_TRIES):
        far, before = scipy.sparse.csgraph.dijkstra(
            scipy.sparse.csr_array(tied), indices=np.array([0]), return_predecessors=True
        )
        if not np.isfinite(far[0, 1]):
            return None
        way = [1]
        while way[-1] != 0:
            way.append(int(before[0, way[-1]]))
        way.reverse()
        blocked = next(
            (
                (a, b)
                for a, b in pairwise(way)
                if (a, b) not in known and not _is_free(a, b, nodes, room, known)
            ),
            None,
        )
        if blocked is None:
            return tuple(nodes[i] for i in way[1:-1])
        a, b = blocked
        tied[a, b] = tied[b, a] = 0.0
    return None


def _is_free(a: int, b: int, nodes: Array, room: Room, known: set[tuple[int, int]]) -> bool:
    free = room.path_clear(nodes[a], nodes[b])
    if free:
        known |= {(a, b), (b, a)}
    return free
