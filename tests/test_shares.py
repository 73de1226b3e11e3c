"""Parts of the tests, of which continuous integration takes another with every commit."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.shares import in_share


@given(st.text(), st.integers(1, 40))
def test_every_test_is_in_exactly_one_share(name, of):
    assert sum(in_share(name, f"{part}/{of}") for part in range(of)) == 1


def test_shares_of_many_tests_are_about_as_large():
    names = [f"tests/a/test_{i}.py::test_it" for i in range(1200)]
    sizes = [sum(in_share(name, f"{part}/12") for name in names) for part in range(12)]
    # Binomial, 100 of 1200: five deviations of 9.6.
    assert max(abs(size - 100) for size in sizes) < 48


@pytest.mark.parametrize("share", ["3", "a/b", "1/0"])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises((ValueError, ZeroDivisionError)):
        in_share("tests/a.py::test_it", share)
