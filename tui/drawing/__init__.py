"""Pictures made of characters: braille canvas, camera, the arm as a wireframe, plots."""

from tui.drawing.camera import Camera
from tui.drawing.canvas import CELL_HEIGHT, CELL_WIDTH, Canvas
from tui.drawing.plot import Cursor, Frame, Series, envelope, plot, plot_frame
from tui.drawing.scale import Scale, linear_scale, log_scale, tick_text
from tui.drawing.wireframe import (
    Wireframe,
    arm_wireframe,
    draw_axis,
    draw_hit,
    draw_points,
    draw_triad,
)

__all__ = [
    "CELL_HEIGHT",
    "CELL_WIDTH",
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
    "tick_text",
]
