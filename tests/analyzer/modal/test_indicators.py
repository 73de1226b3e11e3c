import numpy as np
import pytest
from support.simulated_frfs import modal_frf, poles_of, record

from armodal.analyzer.modal import (
    cmif,
    convert_form,
    frf_sum,
    group_sums,
    mac,
    mif,
    multivariate_mif,
    tracked_cmif,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfForm

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


def test_tracked_curves_keep_their_shape_through_a_crossing():
    tracked = tracked_cmif(frf(np.array([[1.0, 0.2], [-0.2, 1.0]])))
    crossed = np.argmax(tracked.values, axis=1)
    assert crossed[np.argmin(np.abs(FREQ - 20.0))] != crossed[np.argmin(np.abs(FREQ - 40.0))]
    for f in (20.0, 40.0):
        line = np.argmin(np.abs(FREQ - f))
        for i in range(2):
            # Each curve carries one of the two shapes that share no point, on all lines.
            assert max(mac(tracked.left[line, :, i], shape) for shape in SHAPES) > 0.999
    first = tracked.left[:, :, 0]
    assert min(mac(first[0], shape) for shape in first[::50]) > 0.99
    np.testing.assert_allclose(
        np.sort(tracked.values, axis=1), np.sort(cmif(frf(np.array([[1.0, 0.2], [-0.2, 1.0]]))))
    )


@pytest.mark.parametrize("form", list(FrfForm))
def test_mif_falls_at_the_modes_and_nowhere_else(form):
    values = mif(convert_form(frf(np.ones((2, 1))), form))[:, 0]
    assert np.all((values >= 0.0) & (values <= 1.0))
    for f in (20.0, 40.0):
        near = np.abs(FREQ - f) < 2.0
        assert abs(FREQ[near][np.argmin(values[near])] - f) < 0.15
        assert values[near].min() < 0.3
    assert values[np.argmin(np.abs(FREQ - 30.0))] > 0.9


def test_multivariate_mif_shows_two_modes_at_one_frequency():
    poles = poles_of([30.0, 30.05], [0.01, 0.01])
    participation = np.array([[1.0, 0.3], [-0.2, 1.0]])
    residues = SHAPES[:, :, None] * participation[:, None, :] / (2j * poles.imag[:, None, None])
    values = multivariate_mif(record(modal_frf(poles, residues, FREQ, FrfForm.ACCELERANCE), FREQ))
    line = np.argmin(np.abs(FREQ - 30.0))
    assert np.all(np.diff(values, axis=1) >= -1e-12)
    assert np.all(values[line] < 0.1)
    one = multivariate_mif(frf(participation))
    assert one[np.argmin(np.abs(FREQ - 20.0)), 1] > 0.9


def test_multivariate_mif_of_more_references_than_responses_is_refused():
    wide = np.ones((2, 5, FREQ.size), dtype=complex)
    with pytest.raises(EstimateError, match="reciprocity"):
        multivariate_mif(record(wide, FREQ))
