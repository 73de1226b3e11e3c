"""Verdicts marked against their truth, and rates with their intervals."""

import numpy as np
import pytest
from support.gap_results import made_result

from armodal.study.score import mark, rate, size_of_truth


def test_clopper_pearson_intervals_are_the_published_ones():
    """0 of n: 1 - 0.025^(1/n); 5 of 10: 0.187 to 0.813 (any table of binomial limits)."""
    assert rate(0, 49).high == pytest.approx(1 - 0.025 ** (1 / 49))
    assert rate(0, 49).low == 0.0
    assert rate(5, 10).low == pytest.approx(0.187, abs=5e-4)
    assert rate(5, 10).high == pytest.approx(0.813, abs=5e-4)


def truth(*names, verdict="named"):
    effects = [{"name": name, "place": "knuckle", "parameters": {}} for name in names]
    return {"verdict": verdict, "effects": effects}


def test_a_true_name_is_right_and_another_wrong():
    named = made_result("named", ["link_axis"])
    assert mark(truth("link_axis"), named).outcome == "right"
    assert mark(truth("payload"), named).outcome == "wrong name"
    assert mark(truth(verdict="nothing_detectable"), named).outcome == "wrong name"


def test_wrist_gears_between_two_springs_are_a_coupling():
    """The same terms of K; where the driven joint is rigid they are not."""
    coupled = made_result("named", ["coupling"])
    assert mark(truth("wrist_coupling") | {"wrist": "elastic"}, coupled).outcome == "right"
    assert mark(truth("wrist_coupling") | {"wrist": "rigid"}, coupled).outcome == "wrong name"


def test_one_of_two_is_not_yet_right_and_no_wrong_name():
    found = mark(truth("link_axis", "payload"), made_result("named", ["link_axis"]))
    assert (found.outcome, found.n_true_named) == ("missed", 1)


def test_a_true_name_said_twice_is_once_too_often():
    twice = made_result("named", ["link_axis", "link_axis"])
    assert mark(truth("link_axis"), twice).outcome == "wrong name"
    assert mark(truth("link_axis", "link_axis"), twice).outcome == "right"


def test_silence_is_right_on_nulls_and_missed_elsewhere():
    nothing = made_result("nothing_detectable", [])
    assert mark(truth(verdict="nothing_detectable"), nothing).outcome == "right"
    assert mark(truth("rotor"), nothing).outcome == "missed"


def test_an_ambiguous_set_counts_by_whether_it_holds_the_truth():
    either = made_result("ambiguous", [], standing=["servo", "rotor"])
    assert mark(truth("rotor"), either).outcome == "ambiguous with the truth"
    assert mark(truth("payload"), either).outcome == "unsure"


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
        ("microslip", {"stiffness_n_m_per_rad": 600.0, "beside_n_m_per_rad": 400.0}, 1.5),
        ("microslip", {"stiffness_n_m_per_rad": 600.0}, None),  # whose spring is not told
        ("backlash", {"half_rad": 1e-5, "part": 0.3}, 0.3),
        ("backlash", {"half_rad": 1e-5}, None),
    ],
)
def test_the_size_of_a_joints_own_law(name, parameters, expected):
    effect = {"name": name, "place": "a", "parameters": parameters}
    assert size_of_truth(effect, {"a": 100.0}) == expected
