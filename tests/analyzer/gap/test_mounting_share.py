"""How many mountings share a gain, and a servo that only hits gone astray told."""

from types import SimpleNamespace

import numpy as np
import pytest

from armodal.analyzer.gap.decision.mounting_share import is_shared, mountings_worth
from armodal.analyzer.gap.records import Verdict
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.study import make_case


class Weighed:
    """Mountings whose cost is what a fit left of each."""

    def cost_by_mounting(self, y):
        return y


def left(*of_mountings, least_shared=0.0):
    """A fit that leaves so much of every mounting."""
    words = SimpleNamespace(least_shared=least_shared)
    hypothesis = SimpleNamespace(left=of_mountings)
    return SimpleNamespace(hypothesis=hypothesis, last=SimpleNamespace(effect=words), values={})


class Postures:
    def response(self, hypothesis, _values):
        return SimpleNamespace(values=np.array(hypothesis.left, dtype=np.float64).reshape(2, -1))


def hit(name):
    """Lines of three mountings of a posture, hit once each."""
    at = np.arange(3)
    return SimpleNamespace(name=name, sensor_point=at, hit=at * 0, hit_point=np.array([7]))


class TwoPostures:
    """What shared asks of a stage: two postures, solved together."""

    weighings = (Weighed(), Weighed())

    def __init__(self, *names):
        self.lines = tuple(hit(name) for name in names or "ab")

    def once(self, _hypothesis, postures):
        yield [(p, p) for p in postures], Postures()


BEFORE = left(9.0, 9.0, 9.0, 9.0, 9.0, 9.0)


@pytest.mark.parametrize("n", range(1, 7))
def test_n_mountings_that_bring_the_same_are_n(n):
    after = left(*(4.0 if i < n else 9.0 for i in range(6)))
    assert mountings_worth(TwoPostures(), BEFORE, after) == pytest.approx(n)


def test_soft_and_hard_hits_of_a_mounting_are_one():
    after = left(4.0, 4.0, 9.0, 4.0, 4.0, 9.0)
    assert mountings_worth(TwoPostures("a", "a"), BEFORE, after) == pytest.approx(2.0)


def test_one_mounting_that_brings_nearly_all_is_hardly_more_than_one():
    worth = mountings_worth(TwoPostures(), BEFORE, left(0.0, 8.9, 8.9, 8.9, 8.9, 9.0))
    assert worth == pytest.approx(9.4**2 / (81.0 + 4 * 0.01))


def test_where_as_much_is_lost_nothing_is_shared():
    assert mountings_worth(TwoPostures(), BEFORE, left(0.0, 18.0, 9.0, 9.0, 9.0, 9.0)) == 0.0


@pytest.mark.parametrize(("least", "enough"), [(0.0, True), (1.5, True), (2.5, False)])
def test_an_effect_says_how_many_must_share(least, enough):
    after = left(4.0, 4.0, 9.0, 9.0, 9.0, 9.0, least_shared=least)
    assert is_shared(TwoPostures(), BEFORE, after) == enough


@pytest.mark.long
def test_a_servo_that_many_mountings_tell_is_named():
    session = make_case(1, "bench57", "servo", "clear", ladder=True).session()
    result = find_gap(session, gates=False, modes=False, advice=False).result
    assert result.verdict is Verdict.NAMED
    assert [found.name for found in result.effects] == ["servo"]
