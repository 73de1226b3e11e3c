import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from simulated import modal_frf, poles_of, record

from analyzer.modal import cmif, frf_sum, group_sums
from protocols.errors import EstimateError
from protocols.frf_records import FrfForm

FREQ = np.arange(5.0, 60.0, 0.1)
POLES = poles_of([20.0, 40.0], [0.01, 0.01])
SHAPES = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]])


def frf(participation):
    residues = SHAPES[:, :, None] * participation[:, None, :] / (2j * POLES.imag[:, None, None])
    return record(modal_frf(POLES, residues, FREQ, FrfForm.ACCELERANCE), FREQ)


def test_cmif_peaks_at_the_modes_largest_value_first():
    values = cmif(frf(np.array([[1.0, 0.2], [0.3, 1.0]])))
    assert values.shape == (FREQ.size, 2)
    assert np.all(values[:, 0] >= values[:, 1])
    for f in (20.0, 40.0):
        near = np.abs(FREQ - f) < 2.0
        # Line spacing, and the shift of an accelerance peak by zeta^2 f.
        assert abs(FREQ[near][np.argmax(values[near, 0])] - f) < 0.15


def test_sums_add_magnitudes():
    one = frf(np.ones((2, 1)))
    np.testing.assert_allclose(frf_sum(one), np.abs(one.values).sum(axis=(0, 1)))
    sums = group_sums(one, {"left": ["1", "2"], "right": ["3", "4"], "none": ["9"]})
    assert set(sums) == {"left", "right"}
    np.testing.assert_allclose(sums["left"] + sums["right"], frf_sum(one))


def test_groups_without_measured_points_are_refused():
    with pytest.raises(EstimateError, match="none of the groups"):
        group_sums(frf(np.ones((2, 1))), {"a": ["9"]})
