import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.modal import mac, mac_matrix, mcf, mpc, mpd_deg
from armodal.protocols.errors import EstimateError

parts = st.floats(-1.0, 1.0).filter(lambda x: abs(x) > 1e-3)
shapes = st.lists(st.tuples(parts, parts), min_size=4, max_size=4).map(
    lambda rows: np.array([complex(a, b) for a, b in rows])
)


@given(shapes, shapes)
def test_mac_lies_between_zero_and_one(a, b):
    assert 0.0 <= mac(a, b) <= 1.0


@given(shapes, st.tuples(parts, parts))
def test_mac_ignores_complex_scale(a, factor):
    assert mac(a, complex(*factor) * a) == pytest.approx(1.0, abs=1e-12)  # rounding


@given(shapes)
def test_mpc_lies_between_zero_and_one_and_mcf_completes_it(a):
    assert 0.0 <= mpc(a) <= 1.0
    assert mpc(a) + mcf(a) == pytest.approx(1.0)


@given(shapes, st.floats(-3.0, 3.0))
def test_a_turned_real_shape_is_collinear(a, angle):
    turned = a.real * np.exp(1j * angle)
    assert mpc(turned) == pytest.approx(1.0, abs=1e-12)  # rounding
    assert mpd_deg(turned) == pytest.approx(0.0, abs=1e-5)  # rounding under a square root


def test_a_shape_spread_evenly_in_phase_has_no_collinearity():
    assert mpc(np.exp(2j * np.pi * np.arange(8) / 8)) == pytest.approx(0.0, abs=1e-12)


def test_mpd_is_the_deviation_of_two_equal_arms():
    shape = np.exp(1j * np.radians([10.0, -10.0, 10.0, -10.0]))
    assert mpd_deg(shape) == pytest.approx(10.0)


def test_mac_matrix_pairs_columns():
    first = np.eye(3)[:, :2]
    np.testing.assert_allclose(mac_matrix(first, np.eye(3)), [[1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize("bad", [np.zeros(3), np.array([1.0, np.nan, 0.0]), np.ones((2, 2))])
def test_shapes_without_direction_are_refused(bad):
    with pytest.raises(EstimateError):
        mpc(bad)


def test_shapes_of_different_length_are_refused():
    with pytest.raises(EstimateError, match="equal length"):
        mac([1.0, 2.0], [1.0, 2.0, 3.0])
