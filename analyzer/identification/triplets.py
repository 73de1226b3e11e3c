"""Mozzi axes of a mode from every three points, as file 000 does, with their scatter.

Where the part behind the compliance moves as one rigid body, every triplet of its points gives
the same axis; the scatter between triplets says how far that is true (file 000, Table 5, where six
triplets are taken; here all that are not in line).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.screws import MozziAxis, mozzi_axis, rigid_motion
from armodal.protocols.errors import EstimateError

__all__ = ["TripletAxes", "triplet_axes"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

MOST_TRIPLETS = 400  # evenly taken where there are more
WORST_CONDITION = 30.0  # of a triplet's design: beyond, its points are nearly in line


@dataclass(frozen=True, slots=True, kw_only=True)
class TripletAxes:
    """Average axis over the triplets and the scatter about it, in the points' frame."""

    n_triplets: int
    direction: Array  # (3,) unit
    point_m: Array  # (3,) of the average axis, nearest to all axes
    angle_rms_deg: float  # of the triplets' axes against the average
    distance_rms_m: float  # of that point from the triplets' axes


def triplet_axes(points_m: Array, motion: ComplexArray) -> TripletAxes | None:
    """Average Mozzi axis over triplets of points.

    Parameters
    ----------
    points_m
        (n, 3) of a part that is taken as rigid.
    motion
        (n, 3) complex displacement of each point along the frame's axes.

    Returns
    -------
    TripletAxes or None
        None where fewer than two triplets are not in line, or they only translate.
    """
    phase = np.exp(-0.5j * np.angle(np.sum(motion**2)))
    real = motion * phase
    triplets = list(combinations(range(len(points_m)), 3))
    stride = max(1, -(-len(triplets) // MOST_TRIPLETS))
    axes = [
        axis
        for triplet in triplets[::stride]
        if (axis := _axis(points_m[list(triplet)], real[list(triplet)])) is not None
    ]
    if len(axes) < 2:
        return None
    directions = np.array([axis.direction for axis in axes])
    # The direction that makes the smallest angles with all lines, whatever their sense.
    direction = np.linalg.eigh(directions.T @ directions)[1][:, -1]
    across = np.eye(3) - np.einsum("ti,tj->tij", directions, directions)
    places = np.array([axis.point_m for axis in axes])
    # Nearest to all lines; along the average direction nearest to the origin.
    normal = across.sum(axis=0) + np.outer(direction, direction)
    point = np.linalg.solve(normal, np.einsum("tij,tj->i", across, places))
    point = point - direction * (direction @ point)
    sine = np.linalg.norm(np.cross(directions, direction), axis=1)
    away = np.linalg.norm(np.einsum("tij,tj->ti", across, point - places), axis=1)
    return TripletAxes(
        n_triplets=len(axes),
        direction=direction,
        point_m=point,
        angle_rms_deg=float(np.rad2deg(np.sqrt(np.mean(np.arcsin(np.minimum(sine, 1.0)) ** 2)))),
        distance_rms_m=float(np.sqrt(np.mean(away**2))),
    )


def _axis(points_m: Array, motion: ComplexArray) -> MozziAxis | None:
    try:
        fit = rigid_motion(
            np.repeat(points_m, 3, axis=0), np.tile(np.eye(3), (3, 1)), motion.ravel()
        )
    except EstimateError:  # in line
        return None
    if fit.condition > WORST_CONDITION:
        return None
    axis = mozzi_axis(fit.twist.real)
    return axis if isinstance(axis, MozziAxis) else None
