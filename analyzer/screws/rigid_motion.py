"""Least-squares rigid motion of a body from the measured motion of points on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError

__all__ = ["RigidMotion", "rigid_motion"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidMotion:
    """A complex twist at the frame's origin and how well it explains the points."""

    twist: npt.NDArray[np.complex128]  # (6,), linear first
    explained: float  # share of the squared motion that is rigid, 0 to 1
    condition: float  # of the scaled design; large when points are few or in line


def rigid_motion(
    points_m: npt.ArrayLike, directions: npt.ArrayLike, motion: npt.ArrayLike
) -> RigidMotion:
    """Fit one rigid motion to what points did along known directions.

    Parameters
    ----------
    points_m
        (n, 3) where each measurement sits.
    directions
        (n, 3) unit direction of each measurement.
    motion
        (n,) complex amplitude along it.

    Raises
    ------
    EstimateError
        If fewer than six measurements are given, or they leave a rigid motion undetermined
        (all points on one line, say).

    References
    ----------
    File 000, Eq. (10), for any number of points.
    """
    points = np.asarray(points_m, dtype=np.float64)
    along = np.asarray(directions, dtype=np.float64)
    y = np.asarray(motion, dtype=np.complex128)
    if y.size < 6:
        raise EstimateError(
            f"wanted at least 6 measured directions for a rigid motion, got {y.size}; "
            "measure three points that are not in line"
        )
    center = points.mean(axis=0)
    size = max(float(np.sqrt(((points - center) ** 2).sum(axis=1).mean())), 1e-9)
    # Unknowns: velocity at the centroid, and rotation times the size (so that both are lengths).
    arms = (points - center) / size
    design = np.hstack([along, np.cross(arms, along)])
    values = np.linalg.svd(design, compute_uv=False)
    condition = float(values[0] / values[-1]) if values[-1] > 0 else np.inf
    if condition > 1e6:
        raise EstimateError(
            "the points leave a rigid motion undetermined (they lie on one line, or all look in "
            "one direction); measure three points that are not in line"
        )
    solution, *_ = np.linalg.lstsq(design.astype(np.complex128), y, rcond=None)
    rest = y - design @ solution
    rotation = solution[3:] / size
    linear = solution[:3] - np.cross(rotation, center)
    total = float(np.vdot(y, y).real)
    return RigidMotion(
        twist=frozen_array(np.concatenate([linear, rotation]), np.complex128),
        explained=1.0 - float(np.vdot(rest, rest).real) / total if total > 0 else 0.0,
        condition=condition,
    )
