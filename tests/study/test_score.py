"""Verdicts marked against their truth, and rates with their intervals."""

from dataclasses import replace

import pytest
from support.gap_results import made_result

from armodal.study.score import mark, rate


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


@pytest.mark.parametrize(
    ("place", "parameters", "ours", "right"),
    [
        ("link_arm", {}, "link_arm", True),
        ("arm", {}, "link_arm", False),  # a part of another's name
        (["J4", "J5"], {}, "J4 and J5", True),
        (["1", "2"], {}, "points 1 and 2 exchanged", True),
        (["1", "2"], {}, "points 11 and 12 exchanged", False),
        ("all", {"axis": "x"}, "axis x", True),
        ("all", {"axis": "x"}, "axis y", False),
        ("all", {"axis": "x"}, "axis x at point 7", False),  # elsewhere too
        (["7"], {"axis": "x"}, "axis x at point 7", True),
        ("all", {"axis": "y"}, "the roving sensor: y is -y", True),
        ("all", {"axis": "x"}, "the roving sensor: y is -y", False),
        ("all", {"axes": ["x", "z"]}, "the roving sensor: x is z, z is x", True),
        ("all", {"axes": ["x", "z"]}, "the roving sensor: x is -x, y is z, z is y", False),
        ("forearm", {"axis": [0.0, 0.6, 0.8]}, "forearm", True),  # a direction, no channel
        ("hammer", {}, "", True),
        ("base", {}, "base", True),
        ("hammer", {}, "posture stretched", False),
        ("hammer", {"posture": "posture 1"}, "posture posture 1", True),
        ("hammer", {"posture": "posture 1"}, "posture posture 10", False),
        ("hammer", {"posture": "posture 1"}, "hammer", False),
    ],
)
def test_a_place_is_compared_word_by_word_and_axis_by_axis(place, parameters, ours, right):
    true = {"name": "link_axis", "place": place, "parameters": parameters}
    named = made_result("named", ["link_axis"])
    (effect,) = named.effects
    said = replace(named, effects=(replace(effect, place=ours),))
    found = mark({"verdict": "named", "effects": [true]}, said)
    assert found.place_right is right
    assert found.places == (ours,)
