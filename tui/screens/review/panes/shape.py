"""A mode shape moving on the arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from textual import events
from textual.binding import Binding, BindingType

from armodal.analyzer.identification.shape_motion import ShapeMotion, measured_motion
from armodal.analyzer.identification.structural import mozzi_of_shape
from armodal.tui.drawing import Camera, Canvas, Wireframe, arm_wireframe, draw_axis, draw_points
from armodal.tui.screens.review.pane import ReviewPane
from armodal.tui.screens.review.picture import Picture
from armodal.tui.screens.review.posture_view import PostureView
from armodal.tui.screens.review.state import ReviewState

__all__ = ["PANE", "ShapePicture"]

FRAMES_A_SECOND = 24
_TURN_RAD = np.deg2rad(7.5)
_AMPLITUDE = 0.12  # of the reach: the largest motion at amplification 1
_CYCLE_S = 1.6
_SEEN_OVER = 12  # frames the shown rate is averaged over


@dataclass(frozen=True, slots=True, kw_only=True)
class _Scene:
    """Everything of one mode that stays while it moves."""

    wire: Wireframe
    vertex_motion: npt.NDArray[np.complex128]  # (n, 3), scaled to the picture
    point_motion: npt.NDArray[np.complex128]  # (n_points, 3), alike
    axes: tuple[tuple[str, npt.NDArray[np.float64], npt.NDArray[np.float64]], ...]


class ShapePicture(Picture):
    """Wireframe of the arm, still beneath and moving above."""

    HELP = """# Mode shapes
The arm at rest is dim, the mode moves over it. Test points move as measured; the links between
them move with the joint turns and link motions that explain the points. Arrows turn the view,
`+` `-` zoom, `<` `>` change the amplitude, `f` `d` the speed, space stops it. `n` is the next mode,
`l` names the points, `u` hides the arm at rest, `x` the axes, `k` takes the Mozzi axis at another
link. Structural modes have their Mozzi axis drawn, and after Identify the axis found.
"""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("n", "mode(1)", "mode"),
        Binding("b", "mode(-1)", "previous mode", show=False),
        Binding("left", "turn(-1, 0)", "turn", key_display="←↑"),
        Binding("right", "turn(1, 0)", "turn", show=False),
        Binding("up", "turn(0, 1)", "turn", show=False),
        Binding("down", "turn(0, -1)", "turn", show=False),
        Binding("plus,equals_sign", "zoom(1)", "zoom", key_display="+/-"),
        Binding("minus", "zoom(-1)", "zoom out", show=False),
        Binding("greater_than_sign", "amplify(1)", "amplitude", key_display="</>"),
        Binding("less_than_sign", "amplify(-1)", "less", show=False),
        Binding("f", "speed(1)", "speed", key_display="f/d"),
        Binding("d", "speed(-1)", "slower", show=False),
        Binding("space", "pause", "stop"),
        Binding("l", "names", "names"),
        Binding("u", "rest", "at rest", show=False),
        Binding("x", "axes", "axes", show=False),
        Binding("k", "link", "link of the axis", show=False),
        Binding("0", "home", "first view", show=False),
    ]

    def __init__(
        self,
        state: ReviewState,
        *,
        id: str | None = None,  # noqa: A002
        clock: Callable[[], float] = monotonic,
    ) -> None:
        super().__init__(state, id=id)
        self._clock = clock
        self._last_s: float | None = None
        self._frame_s: list[float] = []
        self.phase_rad = 0.0
        self.speed, self.amplification = 1.0, 1.0
        self.running, self.names, self.rest, self.axes = True, False, True, True
        self.axis_link: int | None = None
        self.camera: Camera | None = None
        self._by_hand = False  # the view stays when another mode is shown
        self._scene: tuple[tuple[object, ...], _Scene | None] = ((), None)

    def on_mount(self) -> None:
        """Start the clockwork."""
        self.set_interval(1.0 / FRAMES_A_SECOND, self.tick)

    def tick(self) -> None:
        """Advance the phase by the time that passed; only what is in sight is painted."""
        now = self._clock()
        passed = 0.0 if self._last_s is None else now - self._last_s
        self._last_s = now
        if not self.running or not self.size or not self.is_on_screen:
            return
        self.phase_rad = float(
            (self.phase_rad + 2 * np.pi * self.speed * passed / _CYCLE_S) % (2 * np.pi)
        )
        self.redraw()

    def frames_a_second(self) -> float | None:
        """Rate at which pictures were painted lately."""
        if len(self._frame_s) < 2 or self._frame_s[-1] <= self._frame_s[0]:
            return None
        return (len(self._frame_s) - 1) / (self._frame_s[-1] - self._frame_s[0])

    def action_mode(self, step: int) -> None:
        """Show the next mode."""
        self.state.choose_mode(self.state.mode + step)
        self.redraw()

    def action_turn(self, across: int, up: int) -> None:
        """Go around the arm."""
        if self.camera is not None:
            self._look(self.camera.turned(-across * _TURN_RAD, up * _TURN_RAD))

    def action_zoom(self, way: int) -> None:
        """Go nearer or farther."""
        if self.camera is not None:
            self._look(self.camera.zoomed(1.15**way))

    def action_amplify(self, way: int) -> None:
        """Let the shape move more or less."""
        self.amplification = float(np.clip(self.amplification * 1.3**way, 0.01, 100.0))
        self.redraw()

    def action_speed(self, way: int) -> None:
        """Let it move faster or slower."""
        self.speed = float(np.clip(self.speed * 1.4**way, 0.05, 8.0))

    def action_pause(self) -> None:
        """Stop, or go on."""
        self.running = not self.running
        self.redraw()

    def action_names(self) -> None:
        """Name the points, or not."""
        self.names = not self.names
        self.redraw()

    def action_rest(self) -> None:
        """Show the arm at rest, or not."""
        self.rest = not self.rest
        self.redraw()

    def action_axes(self) -> None:
        """Show axes, or not."""
        self.axes = not self.axes
        self.redraw()

    def action_link(self) -> None:
        """Take the Mozzi axis of the motion at the next link and beyond."""
        links = self.state.opened.superset.n_joints
        if links:
            self.axis_link = 0 if self.axis_link is None else (self.axis_link + 1) % links
            self.redraw()

    def action_home(self) -> None:
        """Return to the view in which the mode moves most."""
        self.camera, self.amplification, self.speed = None, 1.0, 1.0
        self._by_hand = False
        self.redraw()

    def _look(self, camera: Camera) -> None:
        self.camera, self._by_hand = camera, True
        self.redraw()

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Turn by dragging."""
        if event.button and self.camera is not None:
            self._look(self.camera.turned(-0.05 * event.delta_x, 0.1 * event.delta_y))

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Go nearer."""
        event.stop()
        self.action_zoom(1)

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Go farther."""
        event.stop()
        self.action_zoom(-1)

    def paint(self, columns: int, rows: int) -> Canvas:
        """Draw the arm at rest, then the arm in its phase of the mode, axes, points."""
        canvas = Canvas(columns, rows)
        view = self.state.view
        scene = self._scene_of(view)
        if scene is None:
            canvas.label(0, 0, _why_not(view), "bold")
            return canvas
        camera = self.camera
        if camera is None:
            camera = self.camera = _first_view(scene, canvas)
        phase = self.amplification * np.exp(1j * self.phase_rad)
        if self.rest:
            scene.wire.draw(canvas, camera, self.inks.weak)
        moved = (scene.vertex_motion * phase).real
        scene.wire.draw(canvas, camera, self.inks.strong, displacement_m=moved)
        if self.axes:
            half = 0.45 * scene.wire.reach_m
            for row, (name, point, direction) in enumerate(scene.axes):
                letter = chr(ord("A") + row)
                draw_axis(canvas, camera, point, direction, half, self.inks.axis, name=letter)
                canvas.label(0, 1 + row, f"{letter} {name}", self.inks.axis)
        draw_points(
            canvas,
            camera,
            scene.wire,
            self.inks.cursor,
            displacement_m=(scene.point_motion * phase).real,
            names=self.names,
        )
        self._frame_s = [*self._frame_s[-_SEEN_OVER:], self._clock()]
        canvas.label(0, 0, self._caption(view), "bold")
        canvas.label(0, rows - 1, self._manner(), self.inks.plain)
        return canvas

    def _caption(self, view: PostureView) -> str:
        if view.model is None:
            return ""
        mode = view.model.modes[self.state.mode]
        share = view.joint_share[self.state.mode]
        kind = "structural" if view.structural(self.state.mode) else "joints"
        told = "" if share is None else f", {kind} (joints explain {100 * share:.0f} %)"
        return (
            f"mode {self.state.mode + 1}/{len(view.model.modes)}: {mode.f_hz:.2f} Hz, damping "
            f"{100 * mode.damping_ratio:.2f} %{told}"
        )

    def _manner(self) -> str:
        rate = self.frames_a_second()
        told = "stopped" if not self.running else "" if rate is None else f"{rate:.0f} pictures/s"
        return f"amplitude {self.amplification:.2g}  speed {self.speed:.2g}  {told}"

    def _scene_of(self, view: PostureView) -> _Scene | None:
        key = (id(view), self.state.mode, self.axis_link, id(self.state.identification))
        if self._scene[0] != key:
            self._scene = (key, self._made_scene(view))
            self.camera = self.camera if self._by_hand else None
        return self._scene[1]

    def _made_scene(self, view: PostureView) -> _Scene | None:
        arm = self.state.opened.session.header.arm
        measured, joints = view.measured, view.frf.joints_rad
        if measured is None or joints is None or not self.state.n_modes:
            return None
        shape = view.shape(self.state.mode)
        if shape is None:
            return None
        # Turned so that most of the motion is in the real part: rest is then the zero of the cycle.
        shape = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
        wire = arm_wireframe(arm, joints)
        points = measured_motion(measured, shape, len(arm.points))
        vertices = ShapeMotion(arm, joints, wire.link, wire.position_link_m).motion(measured, shape)
        largest = max(float(np.linalg.norm(points.real, axis=1).max()), 1e-30)
        scale = _AMPLITUDE * wire.reach_m / largest
        return _Scene(
            wire=wire,
            vertex_motion=vertices * scale,
            point_motion=points * scale,
            axes=tuple(self._axes_of(view, shape, wire)),
        )

    def _axes_of(
        self, view: PostureView, shape: npt.NDArray[np.complex128], wire: Wireframe
    ) -> list[tuple[str, npt.NDArray[np.float64], npt.NDArray[np.float64]]]:
        found = []
        superset, measured = self.state.opened.superset, view.measured
        structural = view.structural(self.state.mode)
        if measured is not None and (structural or self.axis_link is not None):
            link = self.axis_link or 0
            axis = mozzi_of_shape(superset, measured, shape, link)
            if axis is not None:
                name = f"Mozzi axis, {superset.arm.joints[link].link.name} and beyond"
                found.append((name, axis.point_m, axis.direction))
        names = [joint.link.name for joint in superset.arm.joints]
        for row in (self.state.identification or {}).get("structural", []):
            if structural and row["link"] in names:
                T = wire.T_base_link[names.index(row["link"])]
                point = T[:3, :3] @ np.array(row["point_link_m"]) + T[:3, 3]
                found.append(
                    (f"axis found in {row['link']}", point, T[:3, :3] @ row["direction_link"])
                )
        return found


def _first_view(scene: _Scene, canvas: Canvas) -> Camera:
    """From where the mode moves most, as near as it stays in the picture."""
    motion, rest = scene.vertex_motion.real, scene.wire.everything_m()
    moved = [scene.wire.position_m + way * motion for way in (1.0, -1.0)]
    camera = Camera.around(rest).facing(motion)
    return camera.filling(np.concatenate([rest, *moved]), canvas.width, canvas.height)


def _why_not(view: PostureView) -> str:
    if view.problem:
        return view.problem
    if view.model is None:
        return "fitting…"
    if not view.model.modes:
        return "no mode was found in this posture"
    return "no joint angles were measured: the arm cannot be drawn in this posture"


PANE = ReviewPane(
    title="Shape", place=6, make=lambda parts: (ShapePicture(parts.state, clock=parts.clock),)
)
