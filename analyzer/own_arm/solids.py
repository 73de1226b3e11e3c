"""Surfaces as coal's shapes: triangles for touching, hulls for collisions."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.meshes import coal
from armodal.analyzer.own_arm.surface import Surface

__all__ = ["hull_solid", "touches", "triangle_solid"]

Array = npt.NDArray[np.float64]


def triangle_solid(surface: Surface) -> Any:
    """Return the triangles themselves, in a tree of boxes."""
    return _model(surface.vertices_m, surface.triangles)


def hull_solid(surface: Surface) -> Any:
    """Return the convex hull, which holds the surface and is far quicker to check."""
    hull = surface.hull
    number = {int(old): new for new, old in enumerate(hull.vertices)}
    triangles = np.array([[number[int(i)] for i in face] for face in hull.simplices])
    model = _model(surface.vertices_m[hull.vertices], triangles)
    try:
        model.buildConvexHull(True, "Qt")
    except RuntimeError:
        # A corner with more than 255 neighbours, as a fine disc's: the hull's triangles serve.
        return model
    return model.convex


def touches(solid: Any, other: Any, T_other: Array, T_solid: Array | None = None) -> bool:
    """Whether two shapes meet; their poses (4, 4) are in one frame, the first's own by default."""
    library = coal()
    at = () if T_solid is None else (T_solid[:3, :3], T_solid[:3, 3])
    result = library.CollisionResult()
    return bool(
        library.collide(
            solid,
            library.Transform3s(*at),
            other,
            library.Transform3s(T_other[:3, :3], T_other[:3, 3]),
            library.CollisionRequest(),
            result,
        )
    )


def _model(vertices_m: Array, triangles: npt.NDArray[np.int64]) -> Any:
    model = coal().BVHModelOBBRSS()
    model.beginModel(len(triangles), len(vertices_m))
    model.addVertices(np.ascontiguousarray(vertices_m, dtype=np.float64))
    model.addTriangles(np.ascontiguousarray(triangles, dtype=np.int64))
    model.endModel()
    return model
