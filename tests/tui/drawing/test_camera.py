import numpy as np
import pytest

from armodal.tui.drawing import Camera

EXACT = 1e-9  # rounding of a few products of numbers of size 100


def test_z_is_up_and_y_to_the_right_seen_along_minus_x():
    camera = Camera(
        center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0, azimuth_rad=0.0, elevation_rad=0.0
    )
    middle, y, z = camera.project(np.array([[5.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]), 101, 101)
    assert middle == pytest.approx([50, 50], abs=EXACT)
    assert y[0] > 50
    assert y[1] == pytest.approx(50, abs=EXACT)
    assert z[0] == pytest.approx(50, abs=EXACT)
    assert z[1] < 50


def test_directions_are_a_right_handed_frame():
    camera = Camera(center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0).turned(0.7, 0.4)
    frame = camera.directions()
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=EXACT)
    assert np.linalg.det(frame) == pytest.approx(1.0, abs=EXACT)


def test_the_whole_scene_is_in_the_picture_from_every_side():
    points = np.random.default_rng(0).normal(size=(40, 3))
    camera = Camera.around(points)
    for turn in np.linspace(0, 6, 13):
        at = camera.turned(turn, turn / 6).project(points, 120, 80)
        assert (at >= 0).all()
        assert (at[:, 0] < 120).all()
        assert (at[:, 1] < 80).all()


def test_elevation_stops_overhead_and_zoom_scales_the_picture():
    camera = Camera(center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0)
    assert camera.turned(0.0, 9.0).elevation_rad == pytest.approx(np.pi / 2)
    near = camera.zoomed(2.0)
    assert near.pixels_a_metre(100, 60) == pytest.approx(2 * camera.pixels_a_metre(100, 60))


def test_a_scene_of_nothing_has_a_camera():
    assert Camera.around(np.zeros((0, 3))).radius_m > 0


def test_a_motion_is_faced_from_where_it_is_seen_whole():
    camera = Camera(center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0)
    for azimuth in np.linspace(0.0, 6.0, 7):
        motion = np.array([[np.cos(azimuth), np.sin(azimuth), 0.0]])
        toward = camera.facing(motion).directions()[2]
        # Turned in steps of 5 degrees: at most half a step off.
        assert abs(float(motion[0] @ toward)) <= np.sin(np.deg2rad(2.5)) + EXACT


def test_no_view_around_the_scene_shows_more_of_a_motion_than_the_one_that_faces_it():
    motion = np.random.default_rng(3).normal(size=(9, 3))
    camera = Camera(center_m=np.zeros(3), radius_m=1.0, half_height_m=1.0)

    def seen(view):
        return float(np.sum((motion @ view.directions()[:2].T) ** 2))

    best = seen(camera.facing(motion))
    assert all(
        seen(camera.turned(turn)) <= best + EXACT for turn in np.deg2rad(np.arange(0.0, 360.0, 5.0))
    )
