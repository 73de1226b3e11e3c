"""The arm as a wireframe: links as slender boxes between their frames, test points on stubs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.arrays import frozen_array
from armodal.tui.drawing.camera import Camera
from armodal.tui.drawing.canvas import Canvas

__all__ = ["Wireframe", "arm_wireframe", "draw_axis", "draw_hit", "draw_points", "draw_triad"]

Array = npt.NDArray[np.float64]

_BASE = -1
_THICKNESS = 0.045  # of the reach: side of a link's box
_SHORT = 0.02  # of the reach: links below are drawn as lines


@dataclass(frozen=True, slots=True, kw_only=True)
class Wireframe:
    """Vertices that ride on links, and the edges between them.

    Vertices are given in the frame of the link they ride on, so that a shape can move them.
    """

    link: npt.NDArray[np.int64]  # (n,) link number, -1 the base
    position_link_m: Array  # (n, 3)
    position_m: Array  # (n, 3) in base, in the posture
    edges: npt.NDArray[np.int64]  # (m, 2) vertex numbers
    T_base_link: Array  # (n_links + 1, 4, 4); the last is the base's own
    point_ids: tuple[str, ...]
    point_m: Array  # (n_points, 3) test points in base
    point_rotation: Array  # (n_points, 3, 3), columns are the sensor's axes in base

    @property
    def reach_m(self) -> float:
        """Largest extent of all vertices and points."""
        everything = self.everything_m()
        return float(np.ptp(everything, axis=0).max()) if len(everything) else 0.0

    def everything_m(self) -> Array:
        """Vertices and points, (n, 3), for a camera."""
        return np.vstack([self.position_m, self.point_m])

    def point(self, point_id: str) -> int:
        """Return the number of a test point; KeyError when the arm has none of that name."""
        if point_id not in self.point_ids:
            raise KeyError(point_id)
        return self.point_ids.index(point_id)

    def draw(
        self,
        canvas: Canvas,
        camera: Camera,
        style: str = "",
        *,
        displacement_m: npt.ArrayLike | None = None,
    ) -> None:
        """Draw all edges, moved by `displacement_m` (n, 3) where given."""
        vertices = self.position_m
        if displacement_m is not None:
            vertices = vertices + np.asarray(displacement_m, dtype=np.float64)
        at = camera.project(vertices, canvas.width, canvas.height)
        canvas.segments(at[self.edges[:, 0]], at[self.edges[:, 1]], style)


def arm_wireframe(arm: Arm, joints_rad: npt.ArrayLike) -> Wireframe:
    """Wireframe of an arm in a posture.

    Parameters
    ----------
    arm
        The arm; one without joints gives its points alone.
    joints_rad
        (n_joints,) joint angles.
    """
    names = [joint.link.name for joint in arm.joints]
    poses = np.stack([*(link_pose(arm, name, joints_rad) for name in names), np.eye(4)])
    ends = _link_ends(arm, poses)
    reach = float(np.ptp(np.vstack([poses[:, :3, 3], *(e for _, e in ends)]), axis=0).max())
    link: list[int] = []
    vertices: list[Array] = []  # in base
    edges: list[tuple[int, int]] = []
    for number, (begin, end) in ends:
        corners, lines = _box(begin, end, reach)
        edges += [(a + len(vertices), b + len(vertices)) for a, b in lines]
        vertices += list(corners)
        link += [number] * len(corners)
    for point in arm.points:
        number = names.index(point.link) if point.link in names else _BASE
        at = poses[number, :3, :3] @ point.position_m + poses[number, :3, 3]
        own = [ends_m for which, ends_m in ends if which == number]
        if own:
            edges.append((len(vertices), len(vertices) + 1))
            vertices += [_nearest(at, *own[0]), at]
            link += [number, number]
    rides_on = [names.index(p.link) if p.link in names else _BASE for p in arm.points]
    point_pose = poses[np.array(rides_on, dtype=np.intp)]
    local = np.array([p.position_m for p in arm.points]).reshape(-1, 3)
    rotation = np.array([p.R_link_sensor for p in arm.points]).reshape(-1, 3, 3)
    number_of = np.array(link, dtype=np.int64)
    position = np.array(vertices).reshape(-1, 3)
    T = poses[number_of] if len(number_of) else np.zeros((0, 4, 4))
    return Wireframe(
        link=frozen_array(number_of, np.int64),
        position_link_m=frozen_array(
            np.einsum("nji,nj->ni", T[:, :3, :3], position - T[:, :3, 3]), np.float64
        ),
        position_m=frozen_array(position, np.float64),
        edges=frozen_array(np.array(edges, dtype=np.int64).reshape(-1, 2), np.int64),
        T_base_link=frozen_array(poses, np.float64),
        point_ids=tuple(p.id for p in arm.points),
        point_m=frozen_array(
            np.einsum("nij,nj->ni", point_pose[:, :3, :3], local) + point_pose[:, :3, 3],
            np.float64,
        ),
        point_rotation=frozen_array(point_pose[:, :3, :3] @ rotation, np.float64),
    )


def _link_ends(arm: Arm, poses: Array) -> list[tuple[int, tuple[Array, Array]]]:
    """From each link's frame to the next; the last link reaches to its outermost test point."""
    if not arm.joints:
        return []
    ends = [(_BASE, (np.zeros(3), poses[0, :3, 3]))]
    last = len(arm.joints) - 1
    ends += [(i, (poses[i, :3, 3], poses[i + 1, :3, 3])) for i in range(last)]
    own = [p.position_m for p in arm.points if p.link == arm.joints[last].link.name]
    own.append(arm.joints[last].link.center_m)
    tip = max(own, key=lambda p: float(np.linalg.norm(p)))
    T = poses[last]
    ends.append((last, (T[:3, 3], T[:3, :3] @ tip + T[:3, 3])))
    return ends


def _box(begin: Array, end: Array, reach: float) -> tuple[Array, list[tuple[int, int]]]:
    """Corners (8, 3) and edges of a box along a line; of the line alone where it is short."""
    along = end - begin
    length = float(np.linalg.norm(along))
    if length <= _SHORT * reach:
        return np.stack([begin, end]), [(0, 1)]
    direction = along / length
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    u = np.cross(direction, helper)
    u *= 0.5 * _THICKNESS * reach / np.linalg.norm(u)
    v = np.cross(direction, u)
    ring = np.stack([u + v, v - u, -u - v, u - v])
    edges = [(i, (i + 1) % 4) for i in range(4)]
    edges += [(i + 4, (i + 1) % 4 + 4) for i in range(4)] + [(i, i + 4) for i in range(4)]
    return np.vstack([begin + ring, end + ring]), edges


def _nearest(at: Array, begin: Array, end: Array) -> Array:
    """Point of the segment nearest to `at`."""
    along = end - begin
    share = float((at - begin) @ along) / max(float(along @ along), 1e-12)
    nearest: Array = begin + min(max(share, 0.0), 1.0) * along
    return nearest


def draw_points(
    canvas: Canvas,
    camera: Camera,
    wireframe: Wireframe,
    style: str = "",
    *,
    displacement_m: npt.ArrayLike | None = None,
    names: bool = False,
) -> None:
    """Draw the test points, (n_points, 3) moved by `displacement_m`, with their names if asked."""
    where = wireframe.point_m
    if displacement_m is not None:
        where = where + np.asarray(displacement_m, dtype=np.float64)
    at = camera.project(where, canvas.width, canvas.height)
    for xy, name in zip(at, wireframe.point_ids, strict=True):
        canvas.mark(xy, f"•{name}" if names else "•", style)


def draw_triad(
    canvas: Canvas,
    camera: Camera,
    origin_m: npt.ArrayLike,
    rotation: npt.ArrayLike,
    length_m: float,
    styles: tuple[str, str, str] = ("red", "green", "blue"),
) -> None:
    """Draw a sensor's axes, named x, y, z at their ends; columns of `rotation` (3, 3) in base."""
    start = np.asarray(origin_m, dtype=np.float64)
    ends = start + length_m * np.asarray(rotation, dtype=np.float64).T
    begin = camera.project(start, canvas.width, canvas.height)
    for name, end, style in zip("xyz", ends, styles, strict=True):
        at = camera.project(end, canvas.width, canvas.height)
        canvas.polyline([begin, at], style)
        canvas.mark(at, name, style)


def draw_hit(
    canvas: Canvas,
    camera: Camera,
    point_m: npt.ArrayLike,
    direction: npt.ArrayLike,
    length_m: float,
    style: str = "bold",
) -> None:
    """Draw a dashed arrow whose tip is the point hit; `direction` (3,) is the hammer's."""
    tip = np.asarray(point_m, dtype=np.float64)
    way = np.asarray(direction, dtype=np.float64)
    ends = camera.project(np.stack([tip - length_m * way, tip]), canvas.width, canvas.height)
    _dashes(canvas, ends, style)
    along = ends[1] - ends[0]
    size = float(np.linalg.norm(along))
    if size < 1.0:  # seen end on
        canvas.mark(ends[1], "⊗", style)
        return
    back = along / size * min(6.0, 0.4 * size)
    side = 0.6 * np.array([-back[1], back[0]])
    canvas.polyline([ends[1] - back + side, ends[1], ends[1] - back - side], style)
    canvas.mark(ends[0], "▪", style)


def draw_axis(
    canvas: Canvas,
    camera: Camera,
    point_m: npt.ArrayLike,
    direction: npt.ArrayLike,
    half_length_m: float,
    style: str = "bold",
    *,
    name: str = "",
) -> None:
    """Draw a dashed line in space, its name at the upper end."""
    middle = np.asarray(point_m, dtype=np.float64)
    way = np.asarray(direction, dtype=np.float64) * half_length_m
    ends = camera.project(np.stack([middle - way, middle + way]), canvas.width, canvas.height)
    _dashes(canvas, ends, style)
    canvas.mark(ends[int(np.argmin(ends[:, 1]))], name, style, beside=1)


def _dashes(canvas: Canvas, ends: Array, style: str) -> None:
    """Draw three pixels of every five between two places on the canvas (2, 2)."""
    n = int(np.linalg.norm(ends[1] - ends[0])) + 1
    share = np.arange(n)[np.arange(n) % 5 < 3] / max(n - 1, 1)
    canvas.dots(ends[0] + share[:, None] * (ends[1] - ends[0]), style)
