"""A link cut across a line again and again, so that it bends or twists all along."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.assembly import Assembly, Inertial, Spring
from armodal.hil_sim.newton_euler import skew

__all__ = ["sliced"]

Array = npt.NDArray[np.float64]


def sliced(
    assembly: Assembly,
    link: str,
    line_m: tuple[Array, Array, Array],
    directions: tuple[Array, ...],
    cuts: Sequence[tuple[float, Sequence[Spring]]],
    word: str,
) -> Assembly:
    """Cut a link at places, parts of its length, by a hinge along each direction.

    `line_m` has both ends and the bow: the line is a parabola between its ends, and hinges turn
    with it. Of each of the `cuts` its place and springs, one a direction.
    Pieces are as heavy as long. Straight, they have together the mass, centre and inertia of the
    link. A test point rides on the piece it stands beside.
    """
    near = assembly.carrier_of(link)
    start, end, bow = line_m
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length
    parts = _parts(near.inertial(), axis, length, [part for part, _ in cuts])
    assembly = assembly.replaced(near.loaded(parts[0]))
    at = near.label
    for i, (part, springs) in enumerate(cuts, 1):
        place = start + (end - start) * part + 4.0 * part * (1.0 - part) * bow
        turned = _turned(axis, axis + 4.0 * (1.0 - 2.0 * part) * bow / length)
        before = tuple(
            name
            for name, (on, position) in assembly.points.items()
            if on == link and name not in assembly.perch and (position - place) @ axis < 0.0
        )
        for way, direction in enumerate(directions):
            label = slice_label(word, i, way + 1, link)
            is_last = way == len(directions) - 1
            assembly = assembly.split(
                at,
                label,
                hinge_m=place,
                axis=turned @ direction,
                spring=springs[way],
                before=parts[i - 1] if way == 0 else Inertial(),
                after=parts[i] if is_last else Inertial(),
                points_before=before if way == 0 else (),
            )
            at = label
    return assembly


def _turned(start: Array, end: Array) -> Array:
    """(3, 3) the least rotation that takes one unit direction to another's."""
    end = end / np.linalg.norm(end)
    by = skew(np.cross(start, end))
    return np.asarray(np.eye(3) + by + by @ by / (1.0 + float(start @ end)))


def slice_label(word: str, cut: int, way: int, link: str) -> str:
    """Name of a hinge, cuts and ways counted from one."""
    return f"{word} {cut}.{way} of {link}"


def _parts(whole: Inertial, axis: Array, length: float, places: Sequence[float]) -> list[Inertial]:
    """Masses along the line through the centre, as far apart as the inertia allows."""
    bounds = np.array([0.0, *places, 1.0]) - 0.5
    shares, offsets = np.diff(bounds), 0.5 * (bounds[:-1] + bounds[1:])
    spread = skew(axis)
    steiner = -whole.mass_kg * float(shares @ offsets**2) * spread @ spread
    # A quarter of the smallest moment stays with the pieces themselves.
    room = np.linalg.eigvalsh(whole.inertia_kg_m2)[0] * 0.75 / np.max(np.abs(steiner))
    reach = min(length, float(np.sqrt(room)))
    own = whole.inertia_kg_m2 - reach**2 * steiner
    return [
        Inertial(
            mass_kg=float(share * whole.mass_kg),
            center_m=whole.center_m + reach * float(offset) * axis,
            inertia_kg_m2=share * own,
        )
        for share, offset in zip(shares, offsets, strict=True)
    ]
