"""How the equations of a posture change with the joint angles, all angles at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import Assembly, System, skew
from analyzer.gap.geometry import GeometrySlopes

__all__ = ["Slopes", "angle_slopes"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Slopes:
    """Change of a system with each of k joint angles, per rad; all else stays.

    Stacked: of P postures, the first axis of every array.
    """

    mass: Array  # (k, n, n)
    moved: Array  # (k, m, 3, n)
    seen: Array  # (k, m, 3, n)
    tilted: Array  # (k, m, 3, n)
    hit: Array  # (k, n_hits, 3, n)

    @classmethod
    def stacked(cls, slopes: Sequence[Slopes]) -> Slopes:
        """Return the slopes of several postures as one."""
        return cls(
            **{f.name: np.array([getattr(own, f.name) for own in slopes]) for f in fields(cls)}
        )


def angle_slopes(assembly: Assembly, system: System, geometry: GeometrySlopes) -> Slopes:
    """Return how the matrices change with the angles; effects' own terms and gravity's stay."""
    T = np.stack(assembly.columns, axis=1)
    n = T.shape[1]
    by_link = geometry.link_jacobian @ T  # (k, n_links, 6, n)
    k = len(by_link)
    half = np.zeros((k, n, n))
    whole = []
    for link, inertia in enumerate(assembly.link_inertia):
        piece = system.pieces.get(link)
        if piece is None:
            whole.append(link)
            continue
        turned = assembly.motion_of_pieces(link, by_link[:, link], len(piece.shares))
        pull = (piece.split(inertia) @ piece.motion).reshape(-1, n)
        half += turned.reshape(k, -1, n).swapaxes(1, 2) @ pull
    pull = (np.stack(assembly.link_inertia)[whole] @ system.link_motion[whole]).reshape(-1, n)
    half += by_link[:, whole].reshape(k, -1, n).swapaxes(1, 2) @ pull
    where = assembly.where
    J, dJ = assembly.point_motion(where, T), _point_slopes(assembly, where, T, geometry)
    R, dR = assembly.geometry.point_rotation[where], geometry.point_rotation[:, where]
    R, dR = R.swapaxes(-1, -2), dR.swapaxes(-1, -2)
    return Slopes(
        mass=half + half.swapaxes(1, 2),
        moved=dJ[..., :3, :],
        seen=dR @ J[:, :3] + R @ dJ[..., :3, :],
        tilted=dR @ assembly.weighed(J) + R @ assembly.weighed(dJ),
        hit=_point_slopes(assembly, assembly.lines.hit_point, T, geometry)[..., :3, :],
    )


def _point_slopes(
    assembly: Assembly, points: npt.NDArray[np.int64], T: Array, geometry: GeometrySlopes
) -> Array:
    """(k, n_points, 6, n) change of the points' motion with each angle."""
    found: Array = geometry.point_jacobian[:, points] @ T
    for at, (_, _, still) in assembly.between.items():
        found[:, still[points], :, at] = 0.0
    if assembly.shifts_m:
        motion = assembly.point_motion(points, T)
        for point, shift in assembly.shifts_m.items():
            arm = skew(assembly.geometry.point_rotation[point] @ shift)
            turned = skew(geometry.point_rotation[:, point] @ shift)[:, None]
            rows = points == point
            found[:, rows, :3] -= turned @ motion[rows, 3:] + arm @ found[:, rows, 3:]
    return found
