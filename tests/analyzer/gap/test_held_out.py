"""Postures that are foretold from others, and what a name must foretell of them."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.decision import naming
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.decision.naming import step_to
from armodal.analyzer.gap.effects import bearing
from armodal.analyzer.gap.inference.fit import TOLERANCE, fit_hypothesis
from armodal.analyzer.gap.inference.held_out import held_out
from armodal.analyzer.gap.inference.left_out import foretold_by_priors, left_out
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.analyzer.gap.model.weigh import Quadratic

N_DATA = 8
TEST = (1, 3)
PARAMETERS = (
    Parameter(name="a", unit="", mean=1.0, std=0.5),
    Parameter(name="b", unit="", mean=-2.0, std=2.0),
    Parameter(name="c", unit="", mean=0.0, std=0.1),
    Parameter(name="aim a p1", unit="", mean=0.0, std=0.3),
    Parameter(name="aim b p3", unit="", mean=0.0, std=0.3),
)
AIMS = {3: 1, 4: 3}  # of parameter by column: the only posture it acts in


class LinearStage:
    """Postures whose data are linear in the parameters, with noise of deviation one."""

    def __init__(self, slopes, data):
        self.slopes, self.data = slopes, data
        self.lines = [SimpleNamespace(name=f"p{p}") for p in range(len(data))]

    def quadratics(self, hypothesis, space, values, postures):
        x = np.array(list(values.values()))
        parts = []
        for p in postures:
            r, J = self.slopes[p] @ x - self.data[p], self.slopes[p] * space.std
            parts.append(Quadratic(cost=0.5 * float(r @ r), gradient=J.T @ r, curvature=J.T @ J))
        return parts

    def misfit(self, hypothesis, values, postures):
        return [q.cost for q in self.quadratics(hypothesis, Space(PARAMETERS), values, postures)]

    def whole_quadratic(self, hypothesis, space, values, postures):
        parts = self.quadratics(hypothesis, space, values, postures)
        whole = Quadratic(
            cost=sum(q.cost for q in parts),
            gradient=np.sum([q.gradient for q in parts], axis=0),
            curvature=np.sum([q.curvature for q in parts], axis=0),
        )
        return whole, tuple(q.cost for q in parts)


@pytest.fixture
def stage():
    rng = np.random.default_rng(11)
    slopes = 2.0 * rng.standard_normal((5, N_DATA, len(PARAMETERS)))
    for column, posture in AIMS.items():
        slopes[[p for p in range(5) if p != posture], :, column] = 0.0
    truth = np.array([p.mean + p.std * rng.standard_normal() for p in PARAMETERS])
    return LinearStage(slopes, slopes @ truth + rng.standard_normal((5, N_DATA)))


def predictive(stage, posture, *, given):
    """-ln p of a posture's data, given the others or none."""
    mean, std = np.array([(p.mean, p.std) for p in PARAMETERS]).T
    known = [p for p in range(len(stage.data)) if p != posture] if given else slice(0)
    J, y = stage.slopes[known].reshape(-1, len(PARAMETERS)), stage.data[known].reshape(-1)
    prior = np.diag(std**2)
    gain = prior @ J.T @ np.linalg.inv(J @ prior @ J.T + np.eye(len(y)))
    mean = mean + gain @ (y - J @ mean)
    left = prior - gain @ J @ prior
    own = stage.slopes[posture]
    density = multivariate_normal(own @ mean, own @ left @ own.T + np.eye(N_DATA))
    return -density.logpdf(stage.data[posture])


def fit_to(stage, **more):
    space = Space(PARAMETERS)
    hypothesis = SimpleNamespace(space=lambda: space, instances=(), has_laws=False)
    return fit_hypothesis(stage, hypothesis, **more)


@pytest.mark.parametrize("steps", [0, 12])
@pytest.mark.parametrize(("way", "given"), [(left_out, True), (foretold_by_priors, False)])
def test_a_posture_s_surprise_is_its_predictive_log_density(stage, steps, way, given):
    """Laplace's integrals of a linear problem with Gaussian priors are exact, wherever taken."""
    found = way(stage, fit_to(stage, max_iterations=steps))
    constant = 0.5 * N_DATA * np.log(2.0 * np.pi)
    wanted = [predictive(stage, p, given=given) for p in range(len(stage.data))]
    assert [*found] == [lines.name for lines in stage.lines]
    # 1e-9: rounding, of integrals that are some thousand nats where nothing was fitted.
    np.testing.assert_allclose(np.array([*found.values()]) + constant, wanted, rtol=1e-9)


def test_soft_and_hard_hits_of_a_posture_are_left_out_together(stage):
    twice = LinearStage(
        stage.slopes.reshape(5, 2, N_DATA // 2, -1).reshape(10, N_DATA // 2, -1),
        stage.data.reshape(10, N_DATA // 2),
    )
    twice.lines = [SimpleNamespace(name=f"p{p // 2}") for p in range(10)]
    found, wanted = (left_out(own, fit_to(own)) for own in (twice, stage))
    assert found == pytest.approx(wanted, rel=1e-9)


def test_the_training_has_not_seen_what_is_held_out(stage):
    """An aim that only a held-out posture tells is as believed; the rest is of the others alone."""
    found = held_out(stage, fit_to(stage), TEST)
    assert found.postures == TEST
    others = LinearStage(stage.slopes[[0, 2, 4]], stage.data[[0, 2, 4]])
    # Both end where no step brings as much as the tolerance of a fit.
    assert found.training.cost == pytest.approx(fit_to(others).cost, abs=TOLERANCE)
    np.testing.assert_allclose(found.training.u[list(AIMS)], 0.0, atol=1e-12)


APART = 6.0  # nats
TERM = Instance(effect=bearing.WORDS, place="j1", parameters=PARAMETERS[:1])
WIDER = Instance(effect=bearing.WORDS, place="j1", relaxes={"a": PARAMETERS[0]})
OF_1000 = SimpleNamespace(
    weighings=[SimpleNamespace(n=1000)], lines=[SimpleNamespace(name=name) for name in "pq"]
)


def fit_that_leaves(misfit, *instances):
    """What of a fit the step looks at."""
    half = 0.5 * 0.5 * 1000 * misfit  # of each posture
    hypothesis = Hypothesis(ordinary=None, instances=instances)
    return made_fit(hypothesis, cost=2.0 * half, misfit=(half, half))


def step_where(better, present, gains, monkeypatch, n_named=0):
    """The step with postures that gain so much."""
    surprise = {id(present): dict.fromkeys(gains, 40.0)}
    surprise[id(better)] = {name: 40.0 - gain for name, gain in gains.items()}
    monkeypatch.setattr(naming, "left_out", lambda stage, fit: surprise[id(fit)])
    judged = Judged(
        named=better, standing=(better,), phi=1.0, calibration=made_calibration(apart=APART)
    )
    return step_to(OF_1000, present, judged, better, lambda _: 0.8, n_named, lambda _: None)


@pytest.mark.parametrize(("gain", "is_taken"), [(0.95, False), (1.05, True)])
def test_with_a_name_postures_must_be_foretold_better_from_the_others(gain, is_taken, monkeypatch):
    present, better = fit_that_leaves(0.7), fit_that_leaves(0.6, TERM)
    # Together: one posture alone may speak against it.
    gains = {"p": gain * APART + 5.0, "q": -5.0}
    step, doubt = step_where(better, present, gains, monkeypatch)
    assert (step is not None) == is_taken
    if is_taken:
        assert (step.without, step.fit) == (present, better)
        assert step.gains == pytest.approx(gains)
        assert doubt == ""
    else:
        assert "does not predict" in doubt


@pytest.mark.parametrize(("instance", "is_taken"), [(TERM, False), (WIDER, True)])
def test_what_only_widens_a_prior_may_speak_against_what_is_believed(
    instance, is_taken, monkeypatch
):
    """Of a hammer's gain each posture tells the masses that go with it: from them all is alike."""
    present, better = fit_that_leaves(0.7), fit_that_leaves(0.6, instance)
    gained = {id(present): APART, id(better): 0.0}
    monkeypatch.setattr(
        naming, "foretold_by_priors", lambda stage, fit: dict.fromkeys("pq", gained[id(fit)])
    )
    step, _ = step_where(better, present, {"p": 0.1, "q": -0.1}, monkeypatch)
    assert (step is not None) == is_taken
    if is_taken:
        assert step.gains == {"p": APART, "q": APART}


@pytest.mark.parametrize(
    ("before", "after", "n_named", "is_taken"),
    [
        (4.0, 3.1, 0, False),
        (4.0, 2.9, 0, True),
        (4.0, 2.1, 1, False),
        (4.0, 1.9, 1, True),
        (0.85, 0.79, 1, True),  # little is explained, and nothing is missing any more
    ],
)
def test_what_leaves_most_of_what_is_missing_is_no_name(
    before, after, n_named, is_taken, monkeypatch
):
    present, better = fit_that_leaves(before), fit_that_leaves(after, TERM)
    step, doubt = step_where(better, present, {"p": 100.0}, monkeypatch, n_named)
    assert (step is not None) == is_taken
    assert ("leaves most of what is missing" in doubt) != is_taken
