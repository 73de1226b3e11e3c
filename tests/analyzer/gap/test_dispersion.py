"""How much more postures disagree than independent errors: on quadratics of known scatter."""

from types import SimpleNamespace

import numpy as np
import pytest

from armodal.analyzer.gap.inference.dispersion import dispersion
from armodal.analyzer.gap.model.weigh import Quadratic

N, POSTURES, DIRECTIONS = 60, 5, 60


@pytest.fixture
def rng():
    return np.random.default_rng(5)


def made_stage(parts, names="abcde"):
    """A stage of as many postures as there are parts; of fewer where names are the same."""
    lines = [SimpleNamespace(name=name) for name, _ in zip(names, parts, strict=False)]
    return SimpleNamespace(lines=lines, quadratics=lambda *_: parts)


def scattered(rng, factor):
    """A stage and a fit whose postures' slopes scatter `factor` times as their curvature says."""
    parts = []
    for _ in range(POSTURES):
        root = rng.normal(size=(N, 3 * N)) * 3.0
        curvature = root @ root.T
        slope = np.sqrt(factor) * root @ rng.normal(size=3 * N)
        parts.append(Quadratic(cost=0.0, gradient=slope, curvature=curvature))
    stage = made_stage(parts)
    fit = SimpleNamespace(
        hypothesis=None, space=None, values={}, free=np.ones(N, dtype=bool), parts=parts
    )
    return stage, fit


@pytest.mark.parametrize("factor", [1.5, 4.0])
def test_postures_that_disagree_more_say_by_how_much(factor, rng):
    found = dispersion(*scattered(rng, factor))
    # 60 directions of 4 degrees of freedom each: the mean of chi^2 / 4 scatters by
    # sqrt(2 / 240) = 9 %, a little more since directions are not independent; three deviations.
    assert found == pytest.approx(factor, rel=0.35)


def test_it_is_never_below_one(rng):
    assert dispersion(*scattered(rng, 0.01)) == 1.0


def test_a_posture_alone_says_nothing(rng):
    _, fit = scattered(rng, 9.0)
    assert dispersion(made_stage(fit.parts[:1]), fit) == 1.0


def test_soft_and_hard_hits_of_a_posture_are_no_two_postures(rng):
    stage, fit = scattered(rng, 4.0)
    halves = [
        Quadratic(cost=0.0, gradient=0.5 * p.gradient, curvature=0.5 * p.curvature)
        for p in fit.parts
        for _ in range(2)
    ]
    assert dispersion(made_stage(halves, "aabbccddee"), fit) == pytest.approx(
        dispersion(stage, fit)
    )
