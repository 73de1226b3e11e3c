"""Test points on the outer faces of an arm's bodies.

A place serves where nothing of the body stands before it, where a sensor's foot lies flat, and
where the points together see all six motions of the body: they are chosen one after the other for
the largest determinant of the information of their three axes each (D-optimal; V. Fedorov, Theory
of Optimal Experiments, 1972), lengths in parts of the body's own size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.meshes import coal
from armodal.analyzer.own_arm.solids import touches, triangle_solid
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.robot.remarks import Remarks

__all__ = ["FoundPoint", "body_points", "flat_normal", "frame_of_normal", "probe"]

Array = npt.NDArray[np.float64]

FOOT_M = 0.005  # radius of an accelerometer's foot: 10 mm across
FLAT_M = 0.0005  # what wax or glue fills beneath it
_CURVED_M = 0.002  # what an adapter or putty fills, where nothing is flat
_FREE_M = 0.25  # before a face, for the sensor, its cable and a hammer's head
_TRIED = 400  # places looked at on a body, at most
_ENOUGH = 40  # to choose from
_SHORT_M, _LONG_M = 0.12, 0.35  # bodies with three points and with five
_ON_BASE = 2
_FEWEST = 3  # on a moving body: they tell its six motions


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundPoint:
    """A place on a body, in its frame."""

    id: str
    body: int  # 0 the base
    position_m: Array  # (3,)
    normal: Array  # (3,) unit, outwards
    x_axis: Array  # (3,) unit, along the surface


def body_points(
    bodies: Sequence[ArmBody],
    rng: np.random.Generator,
    said: Remarks,
    reached: Callable[[int, Array, Array], bool] | None = None,
) -> tuple[FoundPoint, ...]:
    """Three to five points a moving body and two on the base, numbered from the flange inwards.

    Where a body has fewer than three flat places, curved ones serve, and that is said.

    Parameters
    ----------
    reached
        Tells of a body's number, a place and its normal whether a hand gets there; where too few
        are reached, others serve.
    """
    found: list[FoundPoint] = []
    for number in [*range(len(bodies) - 1, 0, -1), 0]:
        surface = bodies[number].seen
        wanted = _ON_BASE if number == 0 else _wanted(surface)
        fewest = min(wanted, _FEWEST)
        places = _places(surface, rng, FLAT_M)
        if len(places) < fewest:
            places += _places(surface, rng, _CURVED_M)
            if len(places) >= fewest:
                said.note(
                    f"link {bodies[number].name}",
                    f"has too few places that are flat over {2e3 * FOOT_M:.0f} mm: points lie on "
                    f"curved ones, up to {1e3 * _CURVED_M:g} mm beneath a foot; use an adapter",
                )
        if reached is not None:
            near = [one for one in places if reached(number, *one)]
            places = (
                near
                if len(near) >= 2 * wanted
                else near + [one for one in places if not any(one is other for other in near)]
            )
        if len(places) < fewest:
            said.fault(
                f"link {bodies[number].name}",
                f"wanted {fewest} outer places for a foot of {2e3 * FOOT_M:.0f} mm, found "
                f"{len(places)}; use a shape with faces, cut the arm before it with --tip, or "
                "place its points by hand",
            )
            continue
        chosen = _spread(
            np.array([place for place, _ in places]), surface, min(wanted, len(places))
        )
        for i in chosen:
            place, normal = places[i]
            found.append(
                FoundPoint(
                    id=str(len(found) + 1),
                    body=number,
                    position_m=place,
                    normal=normal,
                    x_axis=frame_of_normal(normal, surface)[:, 0],
                )
            )
    return tuple(found)


def frame_of_normal(normal: Array, surface: Surface) -> Array:
    """Sensor axes (3, 3) as columns: z outwards, x along the surface and the body's length."""
    long = np.linalg.eigh(surface.hull_filling.second_m2)[1][:, ::-1]
    along = next(axis for axis in long.T if abs(axis @ normal) < 0.8)
    x = along - normal * (normal @ along)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(normal, x), normal])


def probe(place: Array, normal: Array, *, free_m: float = _FREE_M) -> tuple[object, Array]:
    """What has to be free before a face: a rod as wide as a sensor's foot, and its pose (4, 4)."""
    library = coal()
    x = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, :3] = np.column_stack([x, np.cross(normal, x), normal])
    # A capsule's caps reach its radius beyond its length; a gap over what counts as flat.
    T[:3, 3] = place + (0.5 * free_m + FOOT_M + 4.0 * FLAT_M) * normal
    return library.Capsule(FOOT_M, free_m), T


def flat_normal(
    surface: Surface, place: Array, normal: Array, *, filled_m: float = FLAT_M
) -> Array | None:
    """The mean normal of a sensor's foot at a place, or None where the surface is not flat there.

    Eight rays round the foot and one in its middle go down onto the triangles; what they find may
    lie `filled_m` off a plane.
    """
    near = 3.0 * FOOT_M
    low, high = surface.boxes
    touching = (low <= place + near).all(axis=1) & (high >= place - near).all(axis=1)
    corners = surface.vertices_m[surface.triangles[touching]]
    x = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    x /= np.linalg.norm(x)
    y = np.cross(normal, x)
    angles = np.arange(8) * np.pi / 4.0
    ring = FOOT_M * (np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * y)
    starts = place + near * normal + np.vstack([np.zeros(3), ring])
    down = _first_hits(corners, starts, -normal)
    height = near - down
    if not np.isfinite(height).all() or np.abs(height).max() > 4.0 * filled_m:
        return None
    # A plane through the nine, and what is left over it.
    A = np.column_stack([np.ones(9), (starts - place) @ x, (starts - place) @ y])
    plane = np.linalg.lstsq(A, height, rcond=None)[0]
    if np.abs(height - A @ plane).max() > filled_m:
        return None
    tilted = normal - plane[1] * x - plane[2] * y
    return np.asarray(tilted / np.linalg.norm(tilted))


def _first_hits(corners: Array, starts: Array, along: Array) -> Array:
    """First triangle of parallel rays, m along each; infinity where a ray meets none.

    Möller, Trumbore, J. Graphics Tools 2 (1997) 21.
    """
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(along, ac)
    det = np.einsum("ij,ij->i", ab, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = starts[:, None] - a
        u = np.einsum("rij,ij->ri", s, p) / det
        q = np.cross(s, ab)
        v = q @ along / det
        t = np.einsum("ij,rij->ri", ac, q) / det
        hit = (np.abs(det) > 1e-18) & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
    first: Array = np.where(hit, t, np.inf).min(axis=1, initial=np.inf)
    return first


def _wanted(surface: Surface) -> int:
    return 3 if surface.size_m < _SHORT_M else 4 if surface.size_m < _LONG_M else 5


def _places(
    surface: Surface, rng: np.random.Generator, filled_m: float
) -> list[tuple[Array, Array]]:
    """Outer places, flat to `filled_m`, drawn evenly over the surface, with outward normals."""
    corners = surface.vertices_m[surface.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    middle = surface.hull_filling.center_m
    solid = triangle_solid(surface)
    found = []
    for face in rng.choice(len(area), size=_TRIED, p=area / area.sum()):
        u, v = rng.uniform(size=2)
        if u + v > 1.0:
            u, v = 1.0 - u, 1.0 - v
        a, b, c = corners[face]
        place = a + u * (b - a) + v * (c - a)
        normal = cross[face] / area[face]
        # Files turn triangles either way: outwards is where the rod before the face is free.
        if normal @ (place - middle) < 0.0:
            normal = -normal
        if touches(solid, *probe(place, normal)):
            continue
        flat = flat_normal(surface, place, normal, filled_m=filled_m)
        if flat is not None:
            found.append((place, flat))
        if len(found) == _ENOUGH:
            break
    return found


def _spread(places: Array, surface: Surface, wanted: int) -> list[int]:
    """Indices of the points that together see most of the body's six motions."""
    size = 0.5 * surface.size_m
    rows = []
    for place in (places - surface.hull_filling.center_m) / size:
        x, y, z = place
        rows.append(np.hstack([np.eye(3), [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]]))
    told = 1e-6 * np.eye(6)
    chosen: list[int] = []
    for _ in range(wanted):
        gain = [np.linalg.slogdet(told + row.T @ row)[1] for row in rows]
        best = max((i for i in range(len(rows)) if i not in chosen), key=lambda i: gain[i])
        chosen.append(best)
        told = told + rows[best].T @ rows[best]
    return chosen
