"""The fit's steps, on problems whose best point another method finds."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import least_squares, lsq_linear

from armodal.analyzer.gap.inference.fit import fit_hypothesis
from armodal.analyzer.gap.model.priors import FARTHEST
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.model.weigh import Quadratic
from armodal.analyzer.gap.outcome import notes_on_its_end


class Residuals:
    """A stage of one posture whose residuals are a function of the parameters."""

    def __init__(self, of, slopes):
        self.of, self.slopes = of, slopes
        self.lines = (None,)
        self.n_tried = 0

    def misfit(self, hypothesis, values, postures):
        self.n_tried += 1
        return [0.5 * float(np.sum(self.of(np.array(list(values.values()))) ** 2))]

    def whole_quadratic(self, hypothesis, space, values, postures):
        x = np.array(list(values.values()))
        r, J = self.of(x), self.slopes(x) * space.std
        whole = Quadratic(cost=0.5 * float(r @ r), gradient=J.T @ r, curvature=J.T @ J)
        return whole, (whole.cost,)


def hypothesis_of(*parameters):
    return SimpleNamespace(space=lambda: Space(parameters), instances=(), has_laws=False)


def test_a_linear_problem_within_bounds_takes_a_step():
    rng = np.random.default_rng(4)
    J, r = rng.standard_normal((50, 12)), 20.0 * rng.standard_normal(50)
    parameters = [
        Parameter(name=f"p{i}", unit="", mean=0.0, std=1.0, low=-0.3, high=0.5) for i in range(12)
    ]
    stage = Residuals(lambda x: J @ x - r, lambda x: J)
    fit = fit_hypothesis(stage, hypothesis_of(*parameters))
    with_prior = np.vstack([J, np.eye(12)]), np.concatenate([r, np.zeros(12)])
    best = lsq_linear(*with_prior, bounds=(-0.3, 0.5), tol=1e-14).x
    assert np.sum((best < -0.299) | (best > 0.499)) > 3
    # The first step is damped by the priors' curvature, a fiftieth of the data's: 0.5 / 50.
    assert fit.u == pytest.approx(best, abs=1e-2)
    assert fit.converged
    assert stage.n_tried <= 2


def test_far_from_a_curved_valley_it_finds_the_bottom():
    """Rosenbrock, Computer J. 3 (1960) 175, within bounds that keep the bottom out."""

    def of(x):
        return 30.0 * np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])

    def slopes(x):
        return 30.0 * np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])

    parameters = (
        Parameter(name="x", unit="", mean=0.0, std=3.0, low=-2.0, high=0.8, start=-1.9),
        Parameter(name="y", unit="", mean=0.0, std=3.0, low=-2.0, high=2.0, start=-1.5),
    )
    fit = fit_hypothesis(Residuals(of, slopes), hypothesis_of(*parameters), max_iterations=60)
    theirs = least_squares(
        lambda x: np.concatenate([of(x), x / 3.0]),
        [-1.9, -1.5],
        bounds=([-2.0, -2.0], [0.8, 2.0]),
        xtol=1e-12,
    )
    # A step that gains less than 0.05 ends the fit; the valley is 900 steep along x.
    assert fit.cost == pytest.approx(theirs.cost, abs=0.05)
    assert fit.values["x"] == pytest.approx(0.8, abs=0.02)


def test_along_a_straight_valley_of_two_that_take_each_other_back_a_step_is_hardly_damped():
    """Damped by each one's own curvature, a thousandth of 1e8, the first step would go nowhere."""
    J = np.array([[1e4, -1e4], [3.0, 3.0]])
    r = np.array([0.0, 6.0])
    parameters = [Parameter(name=n, unit="", mean=0.0, std=1.0) for n in ("x", "y")]
    stage = Residuals(lambda x: J @ x - r, lambda x: J)
    fit = fit_hypothesis(stage, hypothesis_of(*parameters), max_iterations=1)
    # Along the valley 18 of the data and 1 of the prior make 18/19; the damping adds 1.
    assert fit.u == pytest.approx([18 / 20, 18 / 20], rel=1e-6)


def test_a_fit_that_small_steps_ended_still_promises_what_is_left():
    """A valley so narrow that steps along it bring next to nothing before the fit ends."""

    def of(x):
        return np.array([1e4 * (x[1] - np.expm1(x[0])), 20.0 * (1.0 - x[0])])

    def slopes(x):
        return np.array([[-1e4 * np.exp(x[0]), 1e4], [-20.0, 0.0]])

    parameters = [Parameter(name=n, unit="", mean=0.0, std=1.0) for n in ("x", "y")]
    stage, hypothesis = Residuals(of, slopes), hypothesis_of(*parameters)
    theirs = least_squares(lambda x: np.concatenate([of(x), x]), [1.0, np.expm1(1.0)], xtol=1e-14)
    stuck = fit_hypothesis(stage, hypothesis, max_iterations=300)
    assert stuck.n_iterations < 300
    # The valley bends: its quadratic promises what is left to within a fifth.
    assert stuck.promised == pytest.approx(stuck.cost - theirs.cost, rel=0.2)
    ended = fit_hypothesis(stage, hypothesis, start=dict(zip("xy", theirs.x, strict=True)))
    assert ended.promised < 1e-3 * stuck.promised
    assert not notes_on_its_end(ended)
    part = 100.0 * stuck.promised / stuck.cost
    assert f"{part:.2g} % of its misfit" in notes_on_its_end(stuck)[0]


@pytest.mark.parametrize(("pull", "names"), [(4.0, False), (100.0, True)])
def test_an_error_as_far_off_as_any_is_tried_is_told_by_name(pull, names):
    far = {"low": -FARTHEST, "high": FARTHEST}
    parameters = [Parameter(name=n, unit="", mean=0.0, std=1.0, **far) for n in ("mass", "gain")]
    stage = Residuals(lambda x: np.array([10.0 * (x[0] - pull), x[1]]), lambda _: np.diag([10, 1]))
    fit = fit_hypothesis(stage, hypothesis_of(*parameters))
    told = notes_on_its_end(fit)
    assert fit.ordinary_at_limit == ("mass",) * names
    assert ["mass" in note and "gain" not in note for note in told] == [True] * names


def test_a_fit_ends_where_it_is_hopeless():
    rng = np.random.default_rng(4)
    J, r = rng.standard_normal((50, 3)), 20.0 * rng.standard_normal(50)
    stage = Residuals(lambda x: np.sinh(J @ x) - r, lambda x: np.cosh(J @ x)[:, None] * J)
    model = hypothesis_of(*(Parameter(name=f"p{i}", unit="", mean=0.0, std=1.0) for i in range(3)))
    whole = fit_hypothesis(stage, model)
    asked = []

    def after_two(fit):
        asked.append((fit.cost, fit.promised))
        return len(asked) == 3

    part = fit_hypothesis(stage, model, is_hopeless=after_two)
    assert (part.n_iterations, part.cost) == (2, asked[-1][0])
    assert not part.converged
    assert whole.cost < part.cost < asked[0][0]
    # The slope is that where it ended: what it promises there is what was asked of.
    assert part.promised == pytest.approx(asked[-1][1], rel=1e-12)
