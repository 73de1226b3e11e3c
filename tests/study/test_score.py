"""Verdicts marked against their truth, and rates with their intervals."""

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
