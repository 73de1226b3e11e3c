"""Which hits make an FRF, and what is said of the others."""

import dataclasses

import numpy as np
import pytest
from support import hammer
from support.simulated_frfs import poles_of

from armodal.analyzer.modal import hit_choices, posture_frf
from armodal.protocols.frf_records import FrfEstimator
from armodal.protocols.plan_records import Averaging

POLES = poles_of([11.0, 38.0], [0.03, 0.025])


def session(hits, averaging=None, *, seed=3):
    """Hits of one width and peak: noise alone, line by line, makes none unlike the others."""
    rng = np.random.default_rng(seed)
    R = 0.3 * rng.standard_normal((2, 2, 3)) / (2j * POLES.imag[:, None, None])
    return hammer.session(
        POLES,
        R,
        rng=rng,
        hits=hits,
        noise=0.02,
        widths_s=(3e-3, 3e-3),
        peaks_n=(100.0, 100.0),
        averaging=averaging,
        anti_alias=True,
    )


def askew(made, number):
    """One hit with half as much response, as if struck at another point."""
    hits = tuple(
        dataclasses.replace(
            hit, counts=np.concatenate([hit.counts[:, :1], hit.counts[:, 1:] // 2], axis=1)
        )
        if hit.number == number
        else hit
        for hit in made.hits
    )
    return dataclasses.replace(made, hits=hits)


def frf_of(made):
    return posture_frf(made, "p", lambda _: np.eye(3), band_hz=(3.0, 100.0))


def test_an_askew_hit_is_left_out_of_the_average_and_named():
    made = askew(session(6), 2)
    first, second = hit_choices(made, "p")
    assert [hit.hit for hit in first.dropped] == [2]
    assert first.dropped[0].reason == "unlike"
    assert second.dropped == ()
    frf = frf_of(made)
    assert frf.n_hits[0, 0] == 5
    assert frf.n_hits[3, 0] == 6
    without = tuple(hit for hit in made.hits if hit.number != 2)
    # The same five hits without the sixth: the very same numbers.
    np.testing.assert_array_equal(
        frf.values, frf_of(dataclasses.replace(made, hits=without)).values
    )


def test_three_hits_are_averaged_as_they_are():
    made = askew(session(3), 2)
    assert all(choice.dropped == () for choice in hit_choices(made, "p"))


@pytest.mark.long
def test_keeping_the_most_alike_does_not_make_the_variance_too_small():
    ratios = []
    for seed in range(12):
        all_of_them = session(6, seed=seed)
        kept = session(6, Averaging(keep_hits=3), seed=seed)
        choices = hit_choices(kept, "p")
        assert all(len(choice.kept) == 3 for choice in choices)
        assert {hit.reason for choice in choices for hit in choice.dropped} == {"surplus"}
        assert np.median(frf_of(kept).coherence) < 1.0
        ratios.append(np.median(frf_of(kept).variance) / np.median(frf_of(all_of_them).variance))
    # Half as many hits: twice the variance, and 5/4 for having chosen. One ratio scatters by 14 %,
    # the mean of twelve by 4 %; the scatter that few hits show is some per cent off besides.
    assert np.exp(np.mean(np.log(ratios))) == pytest.approx(2.5, rel=0.2)


@pytest.mark.parametrize("estimator", list(FrfEstimator))
def test_the_plan_says_which_estimator(estimator):
    size = {
        one: np.abs(frf_of(session(4, Averaging(estimator=one))).values) for one in FrfEstimator
    }
    # |H1| <= |Hv| <= |H2| on every line, to rounding.
    assert np.all(size[FrfEstimator.H1] <= size[estimator] * (1 + 1e-12))
    assert np.all(size[estimator] <= size[FrfEstimator.H2] * (1 + 1e-12))
