"""Numbers that tell whether a change of them could have changed anything."""

import ablation
import numpy as np
import pytest
from traced_number import TracedNumber

from armodal.analyzer.gap.search import race, rivals


def traced(value, noted, names=("less", "more")):
    return TracedNumber(value, dict(zip(names, (0.7 * value, 1.3 * value), strict=True)), noted)


def test_a_comparison_that_would_come_out_otherwise_is_noted():
    noted: set[str] = set()
    limit = traced(10.0, noted)
    assert not limit > 20.0
    assert limit > 5.0
    assert not noted
    assert limit > 8.0
    assert noted == {"less"}
    assert limit < np.float64(12.0)
    assert noted == {"less", "more"}


def test_what_is_computed_of_it_is_followed():
    noted: set[str] = set()
    limit = 2.0 * traced(10.0, noted) + np.float64(1.0)
    assert isinstance(limit, TracedNumber)
    np.testing.assert_array_equal(np.array([0.0, 100.0]) < np.log(limit), [True, False])
    assert not noted
    np.testing.assert_array_equal(np.array([0.0, 3.2]) < np.log(limit), [True, False])
    assert noted == {"more"}


def test_two_of_them_are_told_apart():
    noted: set[str] = set()
    both = traced(1.0, noted, ("a", "b")) * traced(1.0, noted, ("c", "d"))
    assert both < 1.2
    assert noted == {"b", "d"}


@pytest.mark.parametrize(
    "use",
    [float, int, bool, list(range(5)).__getitem__, np.array, lambda n: np.maximum.reduce([n, 1.0])],
)
def test_where_it_cannot_be_followed_every_change_is_noted(use):
    noted: set[str] = set()
    use(traced(2, noted))
    assert noted == {"less", "more"}


def test_a_number_of_the_workflow_is_traced_wherever_it_is_held():
    before = race.PATIENCE, rivals.PATIENCE
    every = list(ablation.numbers())
    with ablation.traced(every) as noted:
        assert rivals.PATIENCE is race.PATIENCE
        assert rivals.PATIENCE * 1.0 < 3.5
    assert noted == {"search.race.PATIENCE 1.3"}
    assert before == (race.PATIENCE, rivals.PATIENCE)
