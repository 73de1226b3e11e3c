"""A test point put elsewhere on its link: by an offset, or where a tape measure says it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.meshes import coal
from armodal.analyzer.own_arm.points import FOOT_M, flat_normal, frame_of_normal, probe
from armodal.analyzer.own_arm.solids import touches, triangle_solid
from armodal.protocols.errors import ArmError

__all__ = ["by_distances", "measured_on_surface", "on_surface"]

Array = npt.NDArray[np.float64]

FARTHEST_M = 0.05  # off the surface, that is still meant
_STEPS = 4  # of Gauss-Newton: from some 10 mm off to far below what a tape reads
_TAPE_M = 0.005  # a tape's error, that two readings may disagree by
_NEAR_M = 1e-4  # a triangle this near to a place holds it


def on_surface(body: ArmBody, place_m: Array, what: str) -> tuple[Array, Array]:
    """The nearest place of a body's outside, and the sensor's axes there.

    Parameters
    ----------
    place_m
        (3,) in the body's frame.
    what
        The point's name, for messages.

    Returns
    -------
    place : (3,) float64
    R_link_sensor : (3, 3) float64
        Columns are the sensor's axes, z outwards.

    Raises
    ------
    ArmError
        If nothing of the body is drawn, or the place is far off it, covered or not flat.
    """
    if not body.drawn:
        raise ArmError(f"{what}: wanted a link with shapes, nothing is drawn of link {body.name}")
    surface, solid = body.seen, triangle_solid(body.seen)
    place = _nearest(solid, place_m)
    off = float(np.linalg.norm(place - place_m))
    if off > FARTHEST_M:
        raise ArmError(
            f"{what}: wanted a place on link {body.name}, got one {1e3 * off:.0f} mm off its "
            "surface; give it in the link's frame, m"
        )
    low, high = surface.boxes
    near = (low <= place + _NEAR_M).all(axis=1) & (high >= place - _NEAR_M).all(axis=1)
    corners = surface.vertices_m[surface.triangles[near]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1)
    normals = cross[length > 0] / length[length > 0, None]
    free = False
    for normal in (*normals, *-normals):
        if touches(solid, *probe(place, normal)):
            continue
        free = True
        flat = flat_normal(surface, place, normal)
        if flat is not None:
            return place, frame_of_normal(flat, surface)
    reason = f"not flat over {2e3 * FOOT_M:.0f} mm" if free else "covered by the link itself"
    raise ArmError(f"{what}: the place on link {body.name} is {reason}; move it farther")


def by_distances(known_m: Sequence[Array], distances_m: Sequence[float], what: str) -> Array:
    """The two places at given distances from three known ones, (2, 3).

    Parameters
    ----------
    known_m
        Three places (3,) in one frame.

    Raises
    ------
    ArmError
        If the three lie on a line, or no place has these distances.

    References
    ----------
    D. Manolakis, IEEE Trans. Aerosp. Electron. Syst. 32 (1996) 1239, Eqs. 4 to 9.
    """
    p1, p2, p3 = known_m
    r1, r2, r3 = distances_m
    x = p2 - p1
    d = float(np.linalg.norm(x))
    x = x / max(d, 1e-12)
    i = float(x @ (p3 - p1))
    y = p3 - p1 - i * x
    j = float(np.linalg.norm(y))
    if min(d, j) < _TAPE_M:
        raise ArmError(f"{what}: wanted three known points that are not on one line")
    y = y / j
    a = (r1**2 - r2**2 + d**2) / (2.0 * d)
    b = (r1**2 - r3**2 + i**2 + j**2 - 2.0 * i * a) / (2.0 * j)
    square = r1**2 - a**2 - b**2
    # A place in the plane of the three has no height, and the tape's error may make it imaginary.
    if square < -2.0 * r1 * _TAPE_M:
        raise ArmError(
            f"{what}: no place has the distances "
            f"{', '.join(f'{1e3 * r:.0f}' for r in distances_m)} mm from the three; measure again"
        )
    height = np.sqrt(max(square, 0.0)) * np.cross(x, y)
    foot = p1 + a * x + b * y
    return np.array([foot + height, foot - height])


def measured_on_surface(
    body: ArmBody, known_m: Sequence[Array], distances_m: Sequence[float], what: str
) -> tuple[Array, Array]:
    """The place of a body's outside that has three measured distances best, and the axes there.

    The height over the plane of the three is badly told by their distances where it is small; the
    surface tells it instead: Gauss-Newton along the surface.

    Raises
    ------
    ArmError
        As `by_distances` and `on_surface`, or if the distances fit no place of the surface.
    """
    found: list[tuple[float, Array, Array]] = []
    refused: list[ArmError] = []
    for start in by_distances(known_m, distances_m, what):
        try:
            place, axes = on_surface(body, start, what)
            for _ in range(_STEPS):
                away = place - np.array(known_m)
                length = np.linalg.norm(away, axis=1)
                slope = (away / length[:, None]) @ axes[:, :2]
                step = np.linalg.lstsq(slope, np.array(distances_m) - length, rcond=None)[0]
                place, axes = on_surface(body, place + axes[:, :2] @ step, what)
        except ArmError as problem:
            refused.append(problem)
            continue
        length = np.linalg.norm(place - np.array(known_m), axis=1)
        found.append((float(np.abs(length - np.array(distances_m)).max()), place, axes))
    if not found:
        raise refused[0]
    worst, place, axes = min(found, key=lambda one: one[0])
    if worst > 2.0 * _TAPE_M:
        raise ArmError(
            f"{what}: the place of link {body.name} that comes nearest misses a distance by "
            f"{1e3 * worst:.0f} mm; measure again"
        )
    return place, axes


def _nearest(solid: object, place_m: Array) -> Array:
    library = coal()
    request, result = library.DistanceRequest(), library.DistanceResult()
    library.distance(
        solid,
        library.Transform3s(),
        library.Sphere(1e-9),
        library.Transform3s(np.eye(3), np.asarray(place_m, dtype=float)),
        request,
        result,
    )
    return np.array(result.getNearestPoint1(), dtype=np.float64)
