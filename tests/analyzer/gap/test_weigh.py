"""Mounting errors integrated out in closed form, beside the dense covariance."""

import numpy as np
import pytest

from armodal.analyzer.gap.model.columns import Columns
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.weigh import Discrepancy, Weighing
from armodal.analyzer.gap.model.weighed_sums import costs_of, sloped, summed
from armodal.protocols.arm.files import load_arm


def alone(weighing, y, dy):
    """Misfit of one prediction with its derivatives (n, m, 3, L)."""
    return summed([weighing], y[None], Columns.of(dy[:, None]), [0])[0]


def made_lines(rng, n_lines=4, mountings=2):
    shape = (mountings, 3, n_lines)
    values = rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
    return PostureLines(
        name="p",
        joints_rad=np.zeros(6),
        s_rad_s=2j * np.pi * np.linspace(10, 60, n_lines),
        sensor_point=np.arange(mountings),
        hit=np.zeros(mountings, dtype=int),
        hit_point=np.array([0]),
        hit_direction=np.array([[1.0, 0.0, 0.0]]),
        values=values,
        variance=0.01 + 0.01 * rng.random(shape),
        sensor_mass_kg=0.0,
    )


def made_places(rng, lines):
    """What two errors that the channels of a mounting share may change."""
    m, _, n_lines = lines.values.shape
    shape = (m, 3, 2, n_lines)
    return 0.1 * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))


def made_weighing(rng, tolerances, *, places=True):
    lines = made_lines(rng)
    own = made_places(rng, lines) if places else None
    return Weighing(lines, tolerances, Discrepancy(), places=own)


@pytest.fixture(params=[True, False])
def setup(request):
    """Mountings of which places are known only nearly, and exactly."""
    rng = np.random.default_rng(3)
    weighing = made_weighing(rng, load_arm("rv4frl").tolerances, places=request.param)
    lines = weighing.lines
    y = lines.values + 0.05 * rng.standard_normal(lines.values.shape)
    return rng, lines, weighing, y


def dense(weighing, y, *, errors_of=None):
    """-ln p up to a constant, by the covariance of all real residuals of each mounting.

    The mounting's errors act on the prediction `errors_of`, by default on `y` itself.
    """
    turned = y if errors_of is None else errors_of
    total = 0.0
    for m in range(y.shape[0]):
        residual = (weighing.lines.values - y)[m] * weighing.scale[m]  # (3, L)
        r = np.concatenate([residual.real, residual.imag], axis=-1)
        own = np.zeros((3, 3, *r.shape[1:], 3))
        for i in range(3):
            N = (turned[m].T * weighing.scale[m, i][:, None]) * weighing.prior[m, i]
            own[i, i] = np.concatenate([N.real, N.imag])
        shared = weighing.places[m].swapaxes(-1, -2)  # (3, 2L, k): real and imaginary in turn
        shared = np.concatenate([shared[:, ::2], shared[:, 1::2]], axis=1).reshape(r.size, -1)
        N = np.concatenate([own.transpose(0, 2, 1, 3).reshape(r.size, 9), shared], axis=-1)
        total += 0.5 * r.ravel() @ np.linalg.solve(np.eye(r.size) + N @ N.T, r.ravel())
    return total


def test_cost_is_that_of_the_dense_covariance(setup):
    _, _, weighing, y = setup
    wanted = pytest.approx(dense(weighing, y), rel=1e-10)
    assert costs_of([weighing], y[None]) == [wanted]
    assert weighing.cost_by_mounting(y).sum() == wanted


def test_gradient_and_curvature_are_those_of_the_cost_s_linear_model(setup):
    rng, lines, weighing, y = setup
    shape = (3, *lines.values.shape)
    dy = rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
    found = alone(weighing, y, dy)
    assert found.cost == pytest.approx(dense(weighing, y), rel=1e-10)

    # The columns of the mounting's errors stay where they are, as Gauss-Newton has them.
    def cost(step):
        return dense(weighing, y + np.tensordot(step, dy, axes=1), errors_of=y)

    h = 1e-3
    for i in range(3):
        e = h * np.eye(3)[i]
        assert (cost(e) - cost(-e)) / (2 * h) == pytest.approx(found.gradient[i], rel=1e-6)
        second = (cost(e) - 2 * cost(0 * e) + cost(-e)) / h**2
        assert second == pytest.approx(found.curvature[i, i], rel=1e-5)


def test_measurements_that_share_predictions_weigh_as_each_alone():
    rng = np.random.default_rng(8)
    tolerances = load_arm("rv4frl").tolerances
    at = [2, 0, 0, 1, 2, 0]
    weighings = [made_weighing(rng, tolerances) for _ in at]
    shape = weighings[0].lines.values.shape
    y = rng.standard_normal((3, *shape)) + 1j * rng.standard_normal((3, *shape))
    dy = rng.standard_normal((5, 3, *shape)) + 1j * rng.standard_normal((5, 3, *shape))
    whole, costs = summed(weighings, y, Columns.of(dy), at)
    each = [alone(w, y[p], dy[:, p]) for w, p in zip(weighings, at, strict=True)]
    np.testing.assert_allclose(costs, [one.cost for one in each], rtol=1e-12)
    np.testing.assert_allclose(whole.gradient, sum(one.gradient for one in each), rtol=1e-9)
    np.testing.assert_allclose(whole.curvature, sum(one.curvature for one in each), rtol=1e-9)


# Parameters of each point's place, at every other mounting.
PLACES = ((1, 2), (4, 5))
OTHER = np.array([[0, 1], [1, 0], [1, 1]])


def test_what_acts_on_single_mountings_counts_as_whole_columns_do():
    """Of two points, each with two parameters of its own, beside three that act everywhere."""
    rng = np.random.default_rng(9)
    tolerances = load_arm("rv4frl").tolerances
    weighings = [made_weighing(rng, tolerances) for _ in range(3)]
    shape = weighings[0].lines.values.shape

    def drawn(*more):
        return rng.standard_normal((*more, 3, *shape)) + 1j * rng.standard_normal(
            (*more, 3, *shape)
        )

    y = drawn()
    columns = Columns(
        n=3 + 4,
        rows=np.array([0, 3, 6]),
        shared=drawn(3),
        own_rows=np.array([np.where(OTHER, *of) for of in PLACES]),
        own=drawn(2),
    )
    parted, costs = summed(weighings, y, columns, [0, 1, 2])
    whole, same_costs = summed(weighings, y, Columns.of(columns.whole()), [0, 1, 2])
    assert costs == same_costs
    np.testing.assert_allclose(parted.gradient, whole.gradient, rtol=1e-10)
    np.testing.assert_allclose(parted.curvature, whole.curvature, rtol=1e-10)
    cost, gradient = sloped(weighings, y, (y, columns), [0, 1, 2])
    assert cost == pytest.approx(whole.cost, rel=1e-12)
    np.testing.assert_allclose(gradient, whole.gradient, rtol=1e-10)


def test_a_turned_mounting_costs_little_and_a_flipped_axis_much(setup):
    _, lines, weighing, _ = setup
    turn = np.eye(3) + 0.01 * np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]])
    turned = np.einsum("ij,mjl->mil", turn, lines.values)
    flipped = lines.values * np.array([1.0, -1.0, 1.0])[:, None]
    # One degree is within the tilt's prior: about half a nat for each of the two turned channels.
    assert weighing.cost_by_mounting(turned).sum() < 3.0
    assert weighing.cost_by_mounting(flipped).sum() > 100.0


def test_a_channel_beside_every_axis_finds_its_own(setup):
    _, lines, weighing, _ = setup
    table = weighing.cost_by_axis(-lines.values[:, [1, 0, 2]])
    best = table.reshape(2, 3, 6).argmin(axis=-1)
    # Recorded x is minus the prediction's y (1, sign 1), y minus its x, z minus its z.
    np.testing.assert_array_equal(best, [[3, 1, 5]] * 2)
