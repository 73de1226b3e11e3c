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


def scattered(rng, factor):
    """A stage and a fit whose postures' slopes scatter `factor` times as their curvature says."""
    parts = []
    for _ in range(POSTURES):
        root = rng.normal(size=(N, 3 * N)) * 3.0
        curvature = root @ root.T
        slope = np.sqrt(factor) * root @ rng.normal(size=3 * N)
        parts.append(Quadratic(cost=0.0, gradient=slope, curvature=curvature))
    stage = SimpleNamespace(lines=range(POSTURES), quadratics=lambda *_: parts)
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
    alone = SimpleNamespace(lines=range(1), quadratics=lambda *_: fit.parts[:1])
    assert dispersion(alone, fit) == 1.0
