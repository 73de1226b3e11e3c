import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.protocols.arm.files import load_arm
from armodal.tui.drawing import Camera, Canvas, arm_wireframe, draw_hit, draw_points, draw_triad

ARM = load_arm("rv4frl")
ANGLES = np.array([0.1, -0.4, 0.9, 0.3, -0.5, 0.2])
EXACT = 1e-9  # rounding of a chain of six products


def test_points_and_sensor_axes_are_where_the_dynamic_model_has_them():
    wire, posture = arm_wireframe(ARM, ANGLES), Superset(ARM).posture(ANGLES)
    assert wire.point_m == pytest.approx(posture.point_position, abs=EXACT)
    assert wire.point_rotation == pytest.approx(posture.point_rotation, abs=EXACT)


def test_vertices_ride_on_their_links():
    wire = arm_wireframe(ARM, ANGLES)
    T = wire.T_base_link[wire.link]
    moved = np.einsum("nij,nj->ni", T[:, :3, :3], wire.position_link_m) + T[:, :3, 3]
    assert moved == pytest.approx(wire.position_m, abs=EXACT)


def test_a_displaced_arm_is_drawn_elsewhere():
    wire = arm_wireframe(ARM, ANGLES)
    camera = Camera.around(wire.everything_m())
    pictures = []
    for displacement in (None, np.full_like(wire.position_m, 0.1)):
        canvas = Canvas(60, 20)
        wire.draw(canvas, camera, displacement_m=displacement)
        pictures.append(canvas.plain())
    assert pictures[0] != pictures[1]


def test_names_and_hit_are_in_the_picture():
    wire = arm_wireframe(ARM, ANGLES)
    camera, canvas = Camera.around(wire.everything_m()), Canvas(100, 40)
    draw_points(canvas, camera, wire, names=True)
    draw_hit(canvas, camera, wire.point_m[5], -wire.point_rotation[5][:, 2], 0.2)
    text = "\n".join(canvas.plain())
    assert "▪" in text or "⊗" in text
    assert "•" in text
    assert ARM.points[-1].id in text


def test_a_triad_seen_from_a_corner_shows_its_three_axes():
    camera, canvas = Camera(center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0), Canvas(40, 20)
    draw_triad(canvas, camera, np.zeros(3), np.eye(3), 0.8)
    assert set("xyz") <= set("".join(canvas.plain()))


def test_a_hit_seen_end_on_is_a_cross_in_a_circle():
    camera, canvas = Camera(center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0), Canvas(40, 20)
    draw_hit(canvas, camera, np.zeros(3), camera.directions()[2], 0.5)
    assert "⊗" in "".join(canvas.plain())


def test_an_unknown_point_is_refused():
    wire = arm_wireframe(ARM, ANGLES)
    assert wire.point(ARM.points[2].id) == 2
    with pytest.raises(KeyError):
        wire.point("nowhere")
