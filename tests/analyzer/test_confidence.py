"""Quantiles in closed form."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import f

from armodal.analyzer.confidence import f_exceeded_with


@given(chance=st.floats(1e-9, 1.0), dof=st.floats(1.0, 1e6))
def test_f_of_two_degrees_is_exceeded_with_that_chance(chance, dof):
    # scipy's own tail is good to 1e-6 where a chance is small and the degrees are many.
    assert f.sf(f_exceeded_with(chance, dof), 2.0, dof) == pytest.approx(chance, rel=1e-6)
