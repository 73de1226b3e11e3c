"""The running median is scipy's."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from armodal.analyzer.modal.running_median import running_median
from armodal.analyzer.modal.spectra import fast_length


@pytest.mark.parametrize("width", [1, 2, 3, 8, 31, 60])
@pytest.mark.parametrize("n", [1, 2, 7, 60, 301])
def test_it_is_that_of_scipy_at_any_width(width, n):
    values = np.random.default_rng(width * n).normal(size=(2, n))
    by_scipy = scipy.ndimage.median_filter(values, size=(1, width), mode="nearest")
    np.testing.assert_array_equal(running_median(values, width), by_scipy)


def test_a_fast_length_is_that_of_scipy():
    for n in [1, 2, 7, 11, 2047, 2048, 2049, 9973, 131071]:
        assert fast_length(n) == scipy.fft.prev_fast_len(n, real=True)
