"""The surface of a body and what its volume tells: mass properties of a uniform filling.

Volume, centre and second moments of a closed surface are sums over its triangles, each with the
origin a tetrahedron (B. Mirtich, J. Graphics Tools 1 (1996) 31; the products by D. Eberly,
"Polyhedral mass properties", 2002). The convex hull, which is closed always, is by Qhull.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy

from armodal.protocols.errors import ArmError

__all__ = ["Filling", "Surface", "filling"]

Array = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int64]

_SAME_M = 1e-6  # vertices nearer than this are one: files repeat a vertex for each triangle


@dataclass(frozen=True, slots=True, kw_only=True)
class Filling:
    """What fills a closed surface with uniform density."""

    volume_m3: float
    center_m: Array  # (3,)
    second_m2: Array  # (3, 3) mean square about the centre: integral of x xᵀ over the volume

    @property
    def inertia_over_mass_m2(self) -> Array:
        """Inertia about the centre of a unit mass, (3, 3)."""
        return np.asarray(np.trace(self.second_m2) * np.eye(3) - self.second_m2)


@dataclass(frozen=True)
class Surface:
    """Triangles of one body, in its frame, of one or several shells."""

    vertices_m: Array  # (n, 3)
    triangles: Triangles  # (m, 3)

    @cached_property
    def hull(self) -> scipy.spatial.ConvexHull:
        """The convex hull.

        Raises
        ------
        ArmError
            If the surface is flat.
        """
        try:
            return scipy.spatial.ConvexHull(self.vertices_m)
        except (scipy.spatial.QhullError, ValueError) as problem:
            raise ArmError("wanted a surface round a body, got a flat one") from problem

    @cached_property
    def hull_filling(self) -> Filling:
        """What fills the hull."""
        hull = self.hull
        corners = self.vertices_m[hull.simplices]
        inside = self.vertices_m[hull.vertices].mean(axis=0)
        outwards = np.einsum("ij,ij->i", hull.equations[:, :3], _cross_of(corners))
        corners[outwards < 0] = corners[outwards < 0][:, ::-1]
        return filling(corners, inside)

    @cached_property
    def open_edges(self) -> int:
        """Edges that do not lie between exactly two triangles turned alike: 0 if it is closed."""
        _, number = np.unique(
            np.round(self.vertices_m / _SAME_M).astype(np.int64), axis=0, return_inverse=True
        )
        faces = number.reshape(-1)[self.triangles]
        faces = faces[
            (faces[:, 0] != faces[:, 1])
            & (faces[:, 1] != faces[:, 2])
            & (faces[:, 2] != faces[:, 0])
        ]
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        n = int(faces.max(initial=0)) + 1
        there, here = edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0]
        keys, counts = np.unique(there, return_counts=True)
        once = keys[counts == 1]
        return int(len(there) - np.isin(once, here[np.isin(here, once)]).sum())

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Lowest and highest corner of the box round each triangle, (m, 3) each."""
        corners = self.vertices_m[self.triangles]
        return corners.min(axis=1), corners.max(axis=1)

    @property
    def size_m(self) -> float:
        """The longest side of the box round it."""
        return float(np.ptp(self.vertices_m, axis=0).max())


def filling(corners_m: Array, origin_m: Array) -> Filling:
    """Volume, centre and second moments of what triangles (n, 3 corners, 3) enclose."""
    a, b, c = (corners_m[:, i] - origin_m for i in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = float(volume.sum())
    center = np.einsum("i,ij->j", volume, a + b + c) / (4.0 * total)
    s = a + b + c
    second = sum(np.einsum("i,ij,ik->jk", volume, x, x) for x in (a, b, c, s)) / (20.0 * total)
    return Filling(
        volume_m3=total,
        center_m=center + origin_m,
        second_m2=second - np.outer(center, center),
    )


def _cross_of(corners: Array) -> Array:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
