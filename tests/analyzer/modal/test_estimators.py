import numpy as np
import pytest

from armodal.analyzer.modal import (
    coherence_random_error,
    estimate_frf,
    scatter_random_error,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfEstimator

N_FREQ = 40


def spectra(rng, n, *, n_ref=1, n_resp=4, force_noise=0.0, response_noise=0.0):
    """True FRFs, and spectra of random forces with noise of a relative size on either side."""

    def white(*shape):
        return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)

    H = white(n_resp, n_ref, N_FREQ)
    force = white(n, n_ref, N_FREQ)
    response = np.einsum("ijk,njk->nik", H, force)
    size = np.sqrt(np.mean(np.abs(response) ** 2))
    return (
        H,
        force + force_noise * white(*force.shape),
        response + response_noise * size * white(*response.shape),
    )


@pytest.mark.parametrize("estimator", list(FrfEstimator))
@pytest.mark.parametrize("n_ref", [1, 2, 3])
def test_without_noise_every_estimator_gives_the_frf_back(estimator, n_ref):
    H, F, X = spectra(np.random.default_rng(0), 8, n_ref=n_ref)
    found = estimate_frf(F, X, estimator)
    # Rounding, times the condition of three random forces; half the digits in an eigenvector.
    np.testing.assert_allclose(found.values, H, atol=1e-6)
    np.testing.assert_allclose(found.coherence, 1.0, atol=1e-9)


def test_h1_is_low_and_h2_high_and_hv_between_as_their_geometric_mean():
    _, F, X = spectra(np.random.default_rng(1), 20, force_noise=0.3, response_noise=0.3)
    h1, h2, hv = (np.abs(estimate_frf(F, X, e).values) for e in FrfEstimator)
    assert np.all(h1 <= hv)
    assert np.all(hv <= h2)
    np.testing.assert_allclose(hv**2, h1 * h2, rtol=1e-10)  # rounding


@pytest.mark.parametrize(
    ("estimator", "noise"),
    [
        (FrfEstimator.H1, {"response_noise": 0.5}),
        (FrfEstimator.H2, {"force_noise": 0.5}),
    ],
)
def test_each_estimator_is_unbiased_when_noise_is_where_it_says(estimator, noise):
    n = 4000
    H, F, X = spectra(np.random.default_rng(2), n, n_resp=1, **noise)
    right = np.mean(np.abs(estimate_frf(F, X, estimator).values) / np.abs(H))
    other = FrfEstimator.H2 if estimator is FrfEstimator.H1 else FrfEstimator.H1
    wrong = np.mean(np.abs(estimate_frf(F, X, other).values) / np.abs(H))
    # Scatter of a mean over 40 lines of a 4000-record estimate: some 0.002.
    assert right == pytest.approx(1.0, abs=0.01)
    assert abs(wrong - 1.0) > 0.1


def test_one_force_of_two_leaves_the_other_frf_alone():
    H, F, X = spectra(np.random.default_rng(3), 500, n_ref=2, response_noise=0.2)
    found = estimate_frf(F, X)
    z = np.abs(found.values - H) ** 2 / found.variance
    # Mean of 320 exponential variables with mean one, and of 500 records' noise estimates.
    assert np.mean(z) == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize(
    ("records", "estimator", "word"),
    [(1, FrfEstimator.H1, "at least as many records"), (5, FrfEstimator.H2, "as many responses")],
)
def test_too_little_for_several_forces_is_refused(records, estimator, word):
    _, F, X = spectra(np.random.default_rng(4), records, n_ref=2, n_resp=1)
    with pytest.raises(EstimateError, match=word):
        estimate_frf(F, X, estimator)


def test_forces_that_always_act_together_are_refused():
    _, F, X = spectra(np.random.default_rng(5), 5, n_ref=2)
    with pytest.raises(EstimateError, match="dependent"):
        estimate_frf(np.repeat(F[:, :1], 2, axis=1), X)


def test_random_errors_from_coherence_and_scatter_are_the_true_scatter():
    H, F, X = spectra(np.random.default_rng(6), 3 * 400, n_resp=1, response_noise=0.1)
    F, X = F.reshape(400, 3, N_FREQ), X.reshape(400, 3, 1, N_FREQ)
    error, by_coherence, by_scatter = [], [], []
    for f, x in zip(F, X, strict=True):
        power = np.abs(f) ** 2
        single = x / f[:, None]
        mean = (power[:, None] * single).sum(axis=0) / power.sum(axis=0)
        along = (mean[0] / H[0, 0]).real - 1.0
        error.append(along**2)
        found = estimate_frf(f[:, None], x)
        by_coherence.append(coherence_random_error(found.coherence[0], 3) ** 2)
        by_scatter.append((scatter_random_error(single, power, half_width_lines=0).std) ** 2)
    size = np.abs(H[0, 0]) ** 2
    # Forces are random here, and on some lines all three are weak: medians over the 16,000.
    truth = np.median(np.array(error))
    assert np.median(by_coherence) == pytest.approx(np.median(by_scatter / size), rel=0.1)
    # Median of a squared normal over that of a chi-square of four over four: 0.455 / 0.839.
    assert truth / np.median(by_scatter / size) == pytest.approx(0.542, rel=0.15)


def test_three_hits_are_four_real_degrees_of_freedom():
    rng = np.random.default_rng(7)
    inside = []
    for _ in range(500):
        single = 1.0 + 0.1 * (rng.standard_normal((3, 1, 9)) + 1j * rng.standard_normal((3, 1, 9)))
        error = scatter_random_error(single, np.ones((3, 9)), half_width_lines=0)
        assert error.dof == 4.0
        inside.append(np.abs(single.mean(axis=0).real - 1.0) < error.half_width())
    # 4500 intervals, one standard deviation 0.3 %.
    assert np.mean(inside) == pytest.approx(0.95, abs=0.015)


@pytest.mark.parametrize(("coherence", "n"), [(0.9, 1), (1.2, 5), (-0.1, 5)])
def test_impossible_coherence_is_refused(coherence, n):
    with pytest.raises(EstimateError):
        coherence_random_error(coherence, n)


def test_scatter_of_one_hit_is_refused():
    with pytest.raises(EstimateError, match="two hits"):
        scatter_random_error(np.ones((1, 1, 4)), np.ones((1, 4)))
