"""How far a session has come: accepted hits for each planned posture and point."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from armodal.protocols.plan_records import Mode, Plan
from armodal.protocols.session.records import Hit

__all__ = ["accepted_counts", "is_complete", "missing_points", "roving_point"]


def roving_point(plan: Plan, hit: Hit) -> str:
    """Return the point of a hit that moves from point to point under `plan`."""
    return hit.sensor_point if plan.mode is Mode.ROVING_RESPONSE else hit.hit_point


def accepted_counts(plan: Plan, hits: Iterable[Hit]) -> Counter[tuple[str, str]]:
    """Return the number of accepted hits of each (posture, roving point)."""
    return Counter((hit.posture, roving_point(plan, hit)) for hit in hits if hit.verdict.accepted)


def missing_points(plan: Plan, hits: Iterable[Hit]) -> tuple[tuple[str, str], ...]:
    """Return the planned (posture, point) that lack accepted hits, in the plan's order."""
    counts = accepted_counts(plan, hits)
    return tuple(
        (posture.name, point)
        for posture in plan.postures
        for point in posture.points
        if counts[posture.name, point] < plan.hits_per_point
    )


def is_complete(plan: Plan, hits: Iterable[Hit]) -> bool:
    """Return whether every planned point has its accepted hits."""
    return not missing_points(plan, hits)
