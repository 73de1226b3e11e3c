"""What replicas of a model leave."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.inference.misfit import misfit_of_replicas, misfit_per_line
from armodal.analyzer.gap.model.hypothesis import Hypothesis

CHANNELS, LINES = 18, 20
FIT = made_fit(Hypothesis(ordinary=None), cost=100.0)


def stage_that_leaves(z, *, noise):
    """One posture; a part of its variance is scatter."""
    lines = SimpleNamespace(name="p", variance=np.full((CHANNELS // 3, 3, LINES), noise))
    weighing = SimpleNamespace(
        n=2 * z.size, scale=np.full(lines.variance.shape, np.sqrt(2.0)), cleaned=lambda _y: z
    )
    response = SimpleNamespace(values=np.zeros((1, *z.shape)))
    together = SimpleNamespace(response=lambda *_: response)
    return SimpleNamespace(
        lines=[lines], weighings=[weighing], once=lambda *_: [([(0, 0)], together)]
    )


def drawn(rank):
    rng = np.random.default_rng(1)
    u, v = rng.standard_normal((2, CHANNELS, LINES)).reshape(2, CHANNELS, LINES)
    z = (u + 1j * v) if rank is None else np.outer(u[:, 0], v[0]).astype(complex)
    return z.reshape(CHANNELS // 3, 3, LINES)


def test_misfit_counts_real_residuals():
    assert misfit_per_line(stage_that_leaves(drawn(None), noise=0.5), FIT) == pytest.approx(
        200.0 / (2 * CHANNELS * LINES)
    )


def test_replicas_whose_errors_share_one_pattern_scatter_more_than_independent_ones():
    one, many = (stage_that_leaves(drawn(rank), noise=0.5) for rank in (1, None))
    assert misfit_of_replicas(one, FIT, 0.01) > 2.0 * misfit_of_replicas(many, FIT, 0.01)
    # The exponential's 99 % beside its mean is ln 100, its median ln 2: 2000 draws, four deviations
    # of sqrt(0.01 / 2000) / 0.01 and sqrt(0.25 / 2000) / 0.5.
    ratio = misfit_of_replicas(one, FIT, 0.01) / misfit_of_replicas(one, FIT, 0.5)
    assert ratio == pytest.approx(np.log(100.0) / np.log(2.0), rel=0.25)


def test_replicas_leave_scatter_whole_and_errors_in_the_part_that_is_believed():
    z = drawn(None)
    scatter, errors = (
        misfit_of_replicas(stage_that_leaves(z, noise=noise), FIT, 0.5) for noise in (1.0, 0.0)
    )
    # A sum of n exponentials has its median 1 / 3n below its mean: some eight strong modes, 4 %.
    assert scatter == pytest.approx(1.0, abs=0.1)
    assert errors == pytest.approx(0.6 * scatter)  # docs/theory-gap.md: of the assumed variance
