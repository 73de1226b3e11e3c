"""FRFs whose phases run the other way are turned, and no others."""

from dataclasses import replace

import numpy as np
import pytest
from support.simulated_frfs import eight_modes

from armodal.analyzer.time_order import NOTE, in_time_order


@pytest.mark.parametrize("seed", range(5))
def test_a_conjugated_frf_is_turned_back_and_an_ordinary_one_is_left(seed):
    frf = eight_modes(np.random.default_rng(seed)).frf
    assert in_time_order(frf) == (frf, "")
    turned, said = in_time_order(replace(frf, values=frf.values.conj()))
    assert said == NOTE
    np.testing.assert_array_equal(turned.values, frf.values)
