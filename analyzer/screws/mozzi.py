"""The Mozzi axis of a small rigid motion: where it turns, how it slides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = [
    "MozziAxis",
    "Translation",
    "line_angle_rad",
    "line_distance_m",
    "line_sense",
    "mozzi_axis",
]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class MozziAxis:
    """A line, the rotation about it and the slide along it.

    `point_m` is the point of the line nearest the origin of the frame the twist was given in.
    """

    direction: Array  # (3,) unit
    point_m: Array  # (3,)
    rotation: float  # rad (or the twist's own amplitude), not negative
    pitch_m_per_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Translation:
    """A motion without rotation: it has a direction and no axis."""

    displacement: Array  # (3,)


def mozzi_axis(twist: npt.ArrayLike, *, length_m: float = 1.0) -> MozziAxis | Translation:
    """Mozzi axis of a twist.

    Parameters
    ----------
    twist
        (6,) linear first: velocity of the body point at the frame's origin, then rotation.
    length_m
        Size of the body: a rotation that moves this length by less than 1e-9 of the linear part
        is no rotation.

    Returns
    -------
    MozziAxis or Translation

    References
    ----------
    File 001, Eqs. (7) to (12): v_par = (w·v) w/|w|², QM = w x v_perp / |w|². Eq. (9) prints
    |w| once where the projection needs it twice; the vector form of Eq. (12) is used.

    >>> axis = mozzi_axis([0.0, -2.0, 0.5, 0.0, 0.0, 1.0])
    >>> axis.point_m.tolist(), axis.pitch_m_per_rad
    ([2.0, 0.0, 0.0], 0.5)
    """
    values = np.asarray(twist, dtype=np.float64)
    linear, angular = values[:3], values[3:]
    speed = float(np.linalg.norm(angular))
    if speed * length_m <= 1e-9 * float(np.linalg.norm(linear)) or speed == 0.0:
        return Translation(displacement=frozen_array(linear, np.float64))
    return MozziAxis(
        direction=frozen_array(angular / speed, np.float64),
        point_m=frozen_array(np.cross(angular, linear) / speed**2 + 0.0, np.float64),
        rotation=speed,
        pitch_m_per_rad=float(angular @ linear) / speed**2,
    )


def line_angle_rad(direction_a: npt.ArrayLike, direction_b: npt.ArrayLike) -> float:
    """Angle between two lines without sense, 0 to pi/2.

    >>> round(line_angle_rad([1, 0, 0], [-1, 0, 0]), 12)
    0.0
    """
    a = np.asarray(direction_a, dtype=np.float64)
    b = np.asarray(direction_b, dtype=np.float64)
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), abs(a @ b)))


def line_sense(direction: npt.ArrayLike) -> Array:
    """Direction (3,) of a line without sense as it is always written: its largest part positive.

    >>> line_sense([-0.96, 0.0, -0.28]).tolist()
    [0.96, -0.0, 0.28]
    """
    along = np.asarray(direction, dtype=np.float64)
    return along if along[int(np.argmax(np.abs(along)))] >= 0.0 else -along


def line_distance_m(
    point: npt.ArrayLike, line_point: npt.ArrayLike, line_direction: npt.ArrayLike
) -> float:
    """Perpendicular distance from a point to a line.

    >>> line_distance_m([0, 3, 5], [0, 0, 0], [0, 0, 1])
    3.0
    """
    offset = np.asarray(point, dtype=np.float64) - np.asarray(line_point, dtype=np.float64)
    direction = np.asarray(line_direction, dtype=np.float64)
    return float(np.linalg.norm(np.cross(offset, direction)) / np.linalg.norm(direction))
