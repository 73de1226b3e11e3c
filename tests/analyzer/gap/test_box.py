import numpy as np
import pytest
from scipy.optimize import lsq_linear

from armodal.analyzer.gap.inference.box import least_in_box


def drawn(rng, n, rank):
    J = rng.standard_normal((rank, n)) * np.logspace(0.0, 3.0, n)
    return J.T @ J + np.eye(n), 100.0 * rng.standard_normal(n)


@pytest.mark.parametrize("seed", range(20))
def test_no_slope_is_left_but_out_of_the_box(seed):
    rng = np.random.default_rng(seed)
    A, b = drawn(rng, 40, 30)
    low, high = -rng.random(40), rng.random(40)
    low[:5], high[5:10] = 0.0, 0.0  # a step that begins at a bound
    x = least_in_box(A, b, low, high)
    assert np.all((low <= x) & (x <= high))
    slope = (A @ x + b) / np.sqrt(np.diag(A))
    at_low, at_high = x == low, x == high
    assert at_low.any()
    assert at_high.any()
    # Where it is convex these conditions make it the least (Karush, Kuhn and Tucker).
    assert np.all(slope[at_low] >= 0.0)
    assert np.all(slope[at_high] <= 0.0)
    # Rounding of a solution by 40 numbers whose curvatures span six decades.
    assert np.max(np.abs(slope[~(at_low | at_high)])) < 1e-7


def test_it_is_what_scipy_finds():
    rng = np.random.default_rng(1)
    J, r = rng.standard_normal((60, 20)), rng.standard_normal(60)
    low, high = np.full(20, -0.05), np.full(20, 0.1)
    theirs = lsq_linear(J, r, bounds=(low, high), tol=1e-14).x
    assert least_in_box(J.T @ J, -J.T @ r, low, high) == pytest.approx(theirs, abs=1e-9)


def test_without_bounds_it_is_newtons_step():
    rng = np.random.default_rng(2)
    A, b = drawn(rng, 10, 10)
    far = np.full(10, np.inf)
    assert least_in_box(A, b, -far, far) == pytest.approx(-np.linalg.solve(A, b))
