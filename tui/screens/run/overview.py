"""Quality of every point, what is missing, and the time left: small sums over the state."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from armodal.protocols.session.progress import roving_point
from armodal.protocols.session.records import Hit
from armodal.tui.screens.run.state import RunState

__all__ = [
    "PointQuality",
    "hits_left",
    "missing",
    "point_qualities",
    "roving_place",
    "seconds_left",
]

LONGEST_PAUSE_S = 600.0  # lab seconds between hits beyond which somebody was away
FEWEST_INTERVALS = 3
REJECTS_OF_TROUBLE = 2  # rejected hits a wanted one, from which a point is marked


@dataclass(frozen=True, slots=True, kw_only=True)
class PointQuality:
    """What a cell of the grid shows."""

    posture: str
    point: str
    accepted: int
    wanted: int
    rejected: int
    skipped: bool
    here: bool

    @property
    def mark(self) -> str:
        """One character that reads without colour."""
        if self.skipped:
            return "-"
        if self.accepted >= self.wanted:
            return "!" if self.rejected > REJECTS_OF_TROUBLE * self.wanted else "●"
        return "◐" if self.accepted else "○"


def all_hits(state: RunState) -> tuple[Hit, ...]:
    """Return the hits of the whole session, those of an earlier run first."""
    return (*state.earlier_hits, *(judged.hit for judged in state.hits))


def roving_place(state: RunState, hit: Hit) -> tuple[str, str]:
    """Return the posture and the roving point of a hit."""
    return hit.posture, roving_point(state.plan, hit)


def counts_accepted(state: RunState, hit: Hit) -> bool:
    """Whether a hit was accepted, and not taken back since."""
    return hit.verdict.accepted and hit.number not in state.withdrawn


def point_qualities(state: RunState) -> tuple[PointQuality, ...]:
    """Return the quality of every planned point, in the plan's order."""
    rejected: dict[tuple[str, str], int] = {}
    for hit in all_hits(state):
        if not counts_accepted(state, hit):
            key = (hit.posture, roving_point(state.plan, hit))
            rejected[key] = rejected.get(key, 0) + 1
    return tuple(
        PointQuality(
            posture=p.posture,
            point=p.point,
            accepted=p.accepted,
            wanted=p.wanted,
            rejected=rejected.get((p.posture, p.point), 0),
            skipped=p.skipped,
            here=state.here == (p.posture, p.point),
        )
        for p in state.progress
    )


def missing(state: RunState) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Return for each posture the points that lack hits, skipped ones too."""
    lacking: dict[str, list[str]] = {}
    for p in state.progress:
        if p.accepted < p.wanted:
            lacking.setdefault(p.posture, []).append(p.point)
    return tuple((posture, tuple(points)) for posture, points in lacking.items())


def hits_left(state: RunState) -> int:
    """Return how many accepted hits are still wanted; skipped points want none."""
    return sum(max(p.wanted - p.accepted, 0) for p in state.progress if not p.skipped)


def seconds_left(state: RunState) -> float | None:
    """Return wall seconds until the plan is done at the pace so far; None while unknown.

    The pace is the median time from one accepted hit to the next at the same point, and from one
    point to the next, each times what is left of it.
    """
    accepted = [hit for hit in all_hits(state) if counts_accepted(state, hit)]
    within: list[float] = []
    between: list[float] = []
    for before, after in pairwise(accepted):
        gap_s = after.trigger_host_s - before.trigger_host_s
        if not 0.0 < gap_s < LONGEST_PAUSE_S:
            continue
        same = (before.posture, roving_point(state.plan, before)) == (
            after.posture,
            roving_point(state.plan, after),
        )
        (within if same else between).append(gap_s)
    if len(within) + len(between) < FEWEST_INTERVALS:
        return None
    left = hits_left(state)
    points = sum(p.accepted < p.wanted and not p.skipped for p in state.progress)
    per_hit_s, per_point_s = _typical(within, between), _typical(between, within)
    points = min(points, left)
    return (per_hit_s * (left - points) + per_point_s * points) / state.time_scale


def _typical(first: Iterable[float], otherwise: Iterable[float]) -> float:
    values = list(first) or list(otherwise)
    return float(median(values))
