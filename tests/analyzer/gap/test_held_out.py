"""Held-out postures: how surprising they are, and what a name must foretell of them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from support.made_calibration import made_calibration
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.decision import naming
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.decision.naming import step_to
from armodal.analyzer.gap.effects import bearing, encoder_offset
from armodal.analyzer.gap.inference.fit import fit_hypothesis
from armodal.analyzer.gap.inference.held_out import held_out
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


def predictive(stage, test):
    """Mean of the parameters given all postures but `test`, and -ln p of each of those."""
    mean, std = np.array([(p.mean, p.std) for p in PARAMETERS]).T
    known = [p for p in range(len(stage.data)) if p not in test]
    J, y = np.concatenate(stage.slopes[known]), np.concatenate(stage.data[known])
    prior = np.diag(std**2)
    gain = prior @ J.T @ np.linalg.inv(J @ prior @ J.T + np.eye(len(y)))
    mean = mean + gain @ (y - J @ mean)
    left = prior - gain @ J @ prior
    surprise = [
        -multivariate_normal(
            stage.slopes[p] @ mean, stage.slopes[p] @ left @ stage.slopes[p].T + np.eye(N_DATA)
        ).logpdf(stage.data[p])
        for p in test
    ]
    return mean, np.array(surprise)


def test_the_surprise_of_held_out_postures_is_their_predictive_log_density(stage):
    """Of a linear problem with Gaussian priors, where the Laplace integral is exact."""
    mean, surprise = predictive(stage, TEST)
    # An aim told by a held-out posture is no place to begin: 0.9 is three prior deviations.
    told = dict(zip((p.name for p in PARAMETERS), mean, strict=True))
    told |= {"aim a p1": 0.9, "aim b p3": -0.9}
    space = Space(PARAMETERS)
    fit = fit_hypothesis(stage, SimpleNamespace(space=lambda: space, instances=(), has_laws=False))
    found = held_out(stage, replace(fit, u=space.start(told)), TEST)
    assert found.postures == TEST
    # The training begins at its own best point and stays there: what is left is rounding.
    constant = 0.5 * N_DATA * np.log(2.0 * np.pi)
    np.testing.assert_allclose(np.array(found.surprise) + constant, surprise, rtol=1e-9)


APART = 6.0  # nats
RELAXES = {"size": Parameter(name="size", unit="", mean=0.0, std=10.0)}
TERM = Instance(effect=bearing.WORDS, place="j1", parameters=tuple(RELAXES.values()))
RELAXATION = Instance(effect=encoder_offset.WORDS, place="j1", relaxes=RELAXES)
OF_1000 = SimpleNamespace(
    weighings=[SimpleNamespace(n=1000)], lines=[SimpleNamespace(name=name) for name in "pq"]
)


def fit_that_leaves(misfit, *instances):
    """What of a fit the step looks at."""
    half = 0.5 * 0.5 * 1000 * misfit  # of each posture
    hypothesis = Hypothesis(ordinary=None, instances=instances)
    return made_fit(hypothesis, cost=2.0 * half, misfit=(half, half))


def step_where(better, present, gains, monkeypatch, n_named=0):
    """The step with held-out postures that gain so much."""
    surprise = {id(present): np.full(len(gains), 40.0), id(better): 40.0 - np.array(gains)}

    def foretells(stage, fit, test):
        return SimpleNamespace(training=fit, postures=test, surprise=tuple(surprise[id(fit)]))

    monkeypatch.setattr(naming, "held_out", foretells)
    judged = Judged(
        named=better, standing=(better,), phi=1.0, calibration=made_calibration(apart=APART)
    )
    test = tuple(range(len(gains)))
    return step_to(OF_1000, present, judged, better, test, lambda _: 0.8, n_named, lambda _: None)


@pytest.mark.parametrize(
    ("instance", "gain", "is_taken"),
    [
        (TERM, 0.95, False),
        (TERM, 1.05, True),
        (RELAXATION, -1.05, False),
        (RELAXATION, -0.95, True),
    ],
)
def test_a_name_must_foretell_held_out_postures_and_a_wider_prior_must_not_spoil_them(
    instance, gain, is_taken, monkeypatch
):
    present, better = fit_that_leaves(0.7), fit_that_leaves(0.6, instance)
    # Together: one posture alone may speak against it.
    step, doubt = step_where(better, present, [gain * APART + 5.0, -5.0], monkeypatch)
    assert (step is not None) == is_taken
    if is_taken:
        assert (step.without, step.fit) == (present, better)
        assert step.foretold_without.training is present
        assert step.foretold_with.training is better
        assert doubt == ""
    else:
        assert "does not predict" in doubt


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
    step, doubt = step_where(better, present, [100.0], monkeypatch, n_named)
    assert (step is not None) == is_taken
    assert ("leaves most of what is missing" in doubt) != is_taken
