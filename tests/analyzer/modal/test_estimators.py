from dataclasses import replace

import numpy as np
import pytest
from support.simulated_frfs import record

from armodal.analyzer.modal import coherence_random_error
from armodal.analyzer.modal.estimators import single_reference
from armodal.analyzer.modal.random_error import typical_random_errors
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfEstimator

N_FREQ = 40


def spectra(rng, n, *, force_noise=0.0, response_noise=0.0):
    """True FRF, and spectra of random forces with noise of a relative size on either side."""

    def white(*shape):
        return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)

    H = white(N_FREQ)
    force = white(n, N_FREQ)
    response = H * force
    size = np.sqrt(np.mean(np.abs(response) ** 2))
    return (
        H,
        force + force_noise * white(*force.shape),
        response + response_noise * size * white(*response.shape),
    )


def estimated(estimator, F, X):
    power = [(np.abs(side) ** 2).sum(axis=0) for side in (F, X)]
    return single_reference(estimator, *power, (X * F.conj()).sum(axis=0))


@pytest.mark.parametrize("estimator", list(FrfEstimator))
def test_without_noise_every_estimator_gives_the_frf_back(estimator):
    H, F, X = spectra(np.random.default_rng(0), 8)
    value, coherence = estimated(estimator, F, X)
    # Rounding of sums of eight products.
    np.testing.assert_allclose(value, H, rtol=1e-12)
    np.testing.assert_allclose(coherence, 1.0, atol=1e-12)


def test_h1_is_low_and_h2_high_and_hv_between_as_their_geometric_mean():
    _, F, X = spectra(np.random.default_rng(1), 20, force_noise=0.3, response_noise=0.3)
    h1, h2, hv = (np.abs(estimated(e, F, X)[0]) for e in FrfEstimator)
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
    H, F, X = spectra(np.random.default_rng(2), 4000, **noise)
    right = np.mean(np.abs(estimated(estimator, F, X)[0]) / np.abs(H))
    other = FrfEstimator.H2 if estimator is FrfEstimator.H1 else FrfEstimator.H1
    wrong = np.mean(np.abs(estimated(other, F, X)[0]) / np.abs(H))
    # Scatter of a mean over 40 lines of a 4000-record estimate: some 0.002.
    assert right == pytest.approx(1.0, abs=0.01)
    assert abs(wrong - 1.0) > 0.1


def test_the_random_error_from_coherence_is_the_true_scatter():
    H, F, X = spectra(np.random.default_rng(6), 3 * 400, response_noise=0.1)
    F, X = F.reshape(400, 3, N_FREQ), X.reshape(400, 3, N_FREQ)
    error, by_coherence = [], []
    for f, x in zip(F, X, strict=True):
        value, coherence = estimated(FrfEstimator.H1, f, x)
        error.append(((value / H).real - 1.0) ** 2)
        by_coherence.append(coherence_random_error(coherence, 3) ** 2)
    # Forces are random here, and on some lines all three are weak: medians over the 16,000.
    # Median of a squared normal over that of a chi-square of four over four: 0.455 / 0.839.
    assert np.median(error) / np.median(by_coherence) == pytest.approx(0.542, rel=0.15)


@pytest.mark.parametrize(("coherence", "n"), [(0.9, 1), (1.2, 5), (-0.1, 5)])
def test_impossible_coherence_is_refused(coherence, n):
    with pytest.raises(EstimateError):
        coherence_random_error(coherence, n)


def test_typical_random_errors_are_of_the_frfs_that_tell_one():
    """Half of E|error|^2 lies along the FRF; holes and single hits tell nothing."""
    values = np.full((4, 1, 50), 2.0 + 0.0j)
    variance = np.full(values.shape, 0.08)
    variance[1], variance[2] = 0.0, np.inf
    frf = record(values, np.arange(1.0, 51.0), variance=variance)
    coherence, n_hits = np.full(values.shape, 0.9), frf.n_hits.copy()
    coherence[1], n_hits[2] = np.nan, 1
    by_scatter, by_coherence = typical_random_errors(
        replace(frf, coherence=coherence, n_hits=n_hits)
    )
    assert by_scatter == pytest.approx(np.sqrt(0.5 * 0.08) / 2.0)
    assert by_coherence == pytest.approx(float(coherence_random_error(np.array(0.9), 3)))
    nothing = replace(frf, variance=np.zeros(values.shape), n_hits=np.ones_like(n_hits))
    assert typical_random_errors(nothing) == (None, None)
