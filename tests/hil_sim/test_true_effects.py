"""True effects in a verdict's words: sizes, and what a sound arm has beside them."""

import numpy as np
import pytest

from armodal.hil_sim.study.true_effects import description, ordinary_beside, size_of_truth


def test_a_coupling_is_counted_in_the_believed_mean():
    effect = {
        "name": "coupling",
        "place": ["a", "b"],
        "parameters": {"cross_stiffness_n_m_per_rad": -60.0},
    }
    assert size_of_truth(effect, {"a": 100.0, "b": 400.0}) == pytest.approx(-0.3)


def test_a_base_is_as_soft_as_it_is_about_the_line_that_was_found():
    """A footing of 1 and 4 N m/rad whose soft line goes 30 degrees from x, and one square to x."""
    turn = np.deg2rad(30.0)
    soft = np.array([np.cos(turn), np.sin(turn)])
    K = np.outer(soft, soft) + 4.0 * (np.eye(2) - np.outer(soft, soft))
    askew = {
        "name": "base",
        "place": "base",
        "parameters": {
            "rock_x_n_m_per_rad": K[0, 0],
            "rock_y_n_m_per_rad": K[1, 1],
            "rock_xy_n_m_per_rad": K[0, 1],
        },
    }
    found = {"rock_x_about": [*soft, 0.0]}
    assert size_of_truth(askew, {}, found) == pytest.approx(1.0)
    square = {"rock_x_n_m_per_rad": 4.0, "rock_y_n_m_per_rad": 1.0}
    assert size_of_truth(askew | {"parameters": square}, {}) == pytest.approx(0.25)


def test_a_link_cut_once_yields_from_end_to_end_as_the_line_that_was_found():
    """A hinge of 100 N m/rad, told by a maker over another length than the 2 m of that line."""
    told = {"hinge_n_m_per_rad": 100.0, "bending_stiffness_n_m2": 150.0}
    effect = {"name": "link_bending", "place": "arm", "parameters": told}
    found = {"from_m": [0.0, 0.0, 1.0], "to_m": [0.0, 2.0, 1.0]}
    assert size_of_truth(effect, {}, found) == pytest.approx(1.0 / 200.0)
    assert size_of_truth(effect, {}) == pytest.approx(1.0 / 150.0)


def test_a_compensator_is_as_stiff_as_where_it_is_square_to_its_shorter_lever():
    told = {"stiffness_n_per_m": 1e5, "eye_m": [0.3, 0.0, 0.1], "shorter_lever_m": 0.2}
    effect = {"name": "gravity_compensator", "place": "a", "parameters": told}
    assert size_of_truth(effect, {"a": 1e4}) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("name", "parameters", "expected"),
    [
        ("friction", {"limit_n_m": 0.7, "stiffness_n_m_per_rad": None}, 0.7),
        ("microslip", {"stiffness_n_m_per_rad": 600.0, "beside_n_m_per_rad": 200.0}, np.log(4.0)),
        ("microslip", {"stiffness_n_m_per_rad": 600.0}, None),  # whose spring is not told
        ("backlash", {"half_rad": 1e-5, "part": 0.3}, 0.3),
        ("backlash", {"half_rad": 1e-5}, None),
    ],
)
def test_the_size_of_a_joints_own_law(name, parameters, expected):
    effect = {"name": name, "place": "a", "parameters": parameters}
    assert size_of_truth(effect, {"a": 100.0}) == expected


def test_a_late_hammer_is_an_early_accelerometer():
    """With 0.2 ms that the hammer is late anyway, and 0.1 ms of the accelerometer."""
    late = {"name": "delay", "place": "hammer", "parameters": {"delay_s": 6e-4}}
    tables = [
        {"kind": "delay", "channels": ["hammer"], "delay_s": 2e-4},
        {"kind": "delay", "channels": ["acc_x", "acc_y", "acc_z"], "delay_s": 1e-4},
        {"kind": "delay", "channels": ["hammer"], "delay_s": 6e-4},
    ]
    assert size_of_truth(late, {}) == pytest.approx(-6e-4)
    assert ordinary_beside(late, {"plant": {"effects": tables}}) == pytest.approx(-1e-4)


def test_an_encoder_reads_what_its_own_ordinary_error_adds():
    true = {"name": "encoder_offset", "place": "a", "parameters": {"offset_deg": 2.0}}
    tables = [
        {"kind": "encoder_offset", "joint": joint, "offset_deg": degrees}
        for joint, degrees in (("a", 0.25), ("b", 5.0), ("a", 2.0))
    ]
    case = {"plant": {"effects": tables}}
    assert ordinary_beside(true, case) == pytest.approx(-np.deg2rad(0.25))
    assert ordinary_beside(true, {"encoder_offsets_rad": {"a": 0.01}}) == pytest.approx(-0.01)


def test_gains_of_all_points_have_those_of_the_sensor_beside_them():
    factor = {"axis": "y", "factor": 1.3}
    response = [[1.0, 0.0, 0.0], [0.0, 1.02, 0.0], [0.0, 0.0, 1.0]]
    case = {"plant": {"effects": [], "accelerometer": {"response": response}}}
    every = {"name": "channel_gain", "place": "all", "parameters": factor}
    single = {"name": "channel_gain", "place": ["p1"], "parameters": factor}
    assert ordinary_beside(every, case) == pytest.approx(np.log(1.02))
    assert ordinary_beside(single, case) == 0.0
    assert description(every) is None
    assert description(single) == {"axis": "y", "sensor_point": "p1"}


def test_what_nobody_compares_has_no_size():
    assert size_of_truth({"name": "dress_pack", "place": "a", "parameters": {}}, {}) is None
    told_otherwise = {"name": "payload", "place": "a", "parameters": {"weight_n": 20.0}}
    assert size_of_truth(told_otherwise, {}) is None
