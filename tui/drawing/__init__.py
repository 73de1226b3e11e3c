"""Pictures made of characters: braille canvas, camera, the arm as a wireframe, plots."""

from armodal.tui.drawing.camera import Camera
from armodal.tui.drawing.canvas import Canvas
from armodal.tui.drawing.plot import Cursor, Frame, Series, envelope, plot, plot_frame
from armodal.tui.drawing.scale import Scale, linear_scale, log_scale
from armodal.tui.drawing.short_names import short_names
from armodal.tui.drawing.wireframe import (
    Wireframe,
    arm_wireframe,
    draw_axis,
    draw_hit,
    draw_points,
    draw_triad,
)

__all__ = [
    "Camera",
    "Canvas",
    "Cursor",
    "Frame",
    "Scale",
    "Series",
    "Wireframe",
    "arm_wireframe",
    "draw_axis",
    "draw_hit",
    "draw_points",
    "draw_triad",
    "envelope",
    "linear_scale",
    "log_scale",
    "plot",
    "plot_frame",
    "short_names",
]
