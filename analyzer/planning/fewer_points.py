"""Fewer points for a plan that must be short: none that shows a link's motion as no other does.

A rigid link has six motions; three triaxial sensors off one line show them all. Where a link's
points show fewer, these are kept. First such points go as show nothing in their posture that the
link's others do not show there. Then in each posture a link may keep one point, as long as all its
motions are shown in one of the fitted postures. Of points that may go, those that move least in
their posture's modes go first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.planning.selective import SelectivePlan

__all__ = ["fewer_points", "observable_motions"]

Array = npt.NDArray[np.float64]

# Of the largest distance between a link's points: a turn with a shorter lever drowns in the noise.
_LEAST_LEVER = 0.1


def fewer_points(
    plan: SelectivePlan, points: Sequence[Sequence[str]], too_many: int
) -> list[tuple[str, ...]]:
    """Take points out of a plan's tests.

    Parameters
    ----------
    points
        Measured in each test.
    too_many
        Mountings to save in all; fewer are, if more would leave a link's motion unseen.

    Returns
    -------
    list of tuple of str
        By test the points left, in their order. The hit point and the point that moves most in the
        test's own mode are always among them.
    """
    arm = plan.arm
    on = {point.id: point.link for point in arm.points}
    kept = [list(measured) for measured in points]
    sizes = {link: _size_m(plan, link) for link in set(on.values())}

    def shown(test: int, link: str, without: str | None = None) -> int:
        left = [arm.point(p).position_m for p in kept[test] if on[p] == link and p != without]
        return observable_motions(left, sizes[link])

    def adds_nothing(test: int, point: str) -> bool:
        return shown(test, on[point], point) == shown(test, on[point])

    def shown_in_another(test: int, point: str) -> bool:
        link = on[point]
        if sum(on[other] == link for other in kept[test]) == 1:
            return False
        fitted = range(plan.n_fitted)
        before = max(shown(i, link) for i in fitted)
        return before == max(shown(i, link, point if i == test else None) for i in fitted)

    order = _least_moving_first(plan, kept)
    for may_go in (adds_nothing, shown_in_another):
        for test, point in order:
            if too_many > 0 and point in kept[test] and may_go(test, point):
                kept[test].remove(point)
                too_many -= 1
    return [tuple(measured) for measured in kept]


def observable_motions(positions_m: Sequence[Array], size_m: float) -> int:
    """How many of a rigid body's six motions triaxial sensors at these places show.

    Parameters
    ----------
    positions_m
        (3,) each, in the body's frame.
    size_m
        Length that levers are compared with.
    """
    if not positions_m:
        return 0
    places = (np.array(positions_m) - np.mean(positions_m, axis=0)) / size_m
    rows = [
        np.hstack([np.eye(3), [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]]) for x, y, z in places
    ]
    return int(np.linalg.matrix_rank(np.vstack(rows), tol=_LEAST_LEVER))


def _size_m(plan: SelectivePlan, link: str) -> float:
    places = np.array([point.position_m for point in plan.arm.points if point.link == link])
    far = float(np.linalg.norm(places[:, None] - places, axis=2).max())
    return far if far > 0.0 else 1.0


def _least_moving_first(
    plan: SelectivePlan, points: Sequence[Sequence[str]]
) -> list[tuple[int, str]]:
    """Test and point of every mounting that may be spared."""
    superset = Superset(plan.arm)
    columns = [superset.joint_column(joint) for joint in plan.elastic.joints]
    ranked: list[tuple[float, int, str]] = []
    for number, (test, measured) in enumerate(zip(plan.tests, points, strict=True)):
        J = superset.posture(test.joints_rad).point_jacobian[:, :3][:, :, columns]
        motion = np.linalg.norm(J @ test.modes.shape, axis=1)  # (points, modes)
        largest = (motion / motion.max(axis=0)).max(axis=1)
        ranked += [
            (float(moves), number, point.id)
            for moves, point in zip(largest, plan.arm.points, strict=True)
            if point.id in measured and point.id not in (plan.hit_point, test.points[0])
        ]
    return [(number, point) for _, number, point in sorted(ranked)]
