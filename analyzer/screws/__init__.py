"""Screws: rigid-body motion of a set of points, and its Mozzi axis."""

from armodal.analyzer.screws.mozzi import (
    MozziAxis,
    Translation,
    line_angle_rad,
    line_distance_m,
    line_sense,
    mozzi_axis,
)
from armodal.analyzer.screws.rigid_motion import RigidMotion, rigid_motion

__all__ = [
    "MozziAxis",
    "RigidMotion",
    "Translation",
    "line_angle_rad",
    "line_distance_m",
    "line_sense",
    "mozzi_axis",
    "rigid_motion",
]
