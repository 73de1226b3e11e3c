"""Which points a planned test measures."""

from __future__ import annotations

from armodal.analyzer.planning.selective import PlannedTest, SelectivePlan

__all__ = ["measured_points"]


def measured_points(plan: SelectivePlan) -> list[tuple[str, ...]]:
    """By test, the points on what moves, then those on the base; only such as a hand reaches."""
    return [_measured(plan, test) for test in plan.tests]


def _measured(plan: SelectivePlan, test: PlannedTest) -> tuple[str, ...]:
    moving = [point.id for point in plan.arm.points if point.link != "base"]
    if test.reachable is None:
        return tuple(moving)
    base = [point.id for point in plan.arm.points if point.link == "base"]
    return tuple(point for point in (*moving, *base) if point in test.reachable)
