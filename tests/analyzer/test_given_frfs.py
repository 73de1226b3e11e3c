from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.given_frfs import complete_points, with_variance
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

FREQ = np.arange(1.0, 101.0)


def level_frfs(coherence, n_hits):
    """Three FRFs of magnitude 2, so that smoothing over lines changes nothing."""
    values = 2.0 * np.exp(1j * np.linspace(0, 3, 100)) * np.ones((3, 1, 1))
    z = np.array([0.0, 0.0, 1.0])
    return FrequencyResponse(
        posture="one",
        form=FrfForm.ACCELERANCE,
        freq_hz=FREQ,
        decay_rad_s=0.0,
        values=values,
        coherence=np.broadcast_to(np.array(coherence, float)[:, None, None], values.shape),
        variance=np.zeros(values.shape),
        n_hits=np.full((3, 1), n_hits),
        responses=tuple(Dof(point=str(i), label="z", direction=z) for i in range(3)),
        references=(Dof(point="0", label="hit", direction=-z),),
        joints_rad=None,
    )


@pytest.mark.parametrize("n", [2, 5, 30])
def test_the_variance_is_that_of_coherence_and_averages(n):
    """Bendat and Piersol: |H|^2 (1 - g)/(g (n - 1)), over lines that scatter as n averages do."""
    noise = np.random.default_rng(n).gamma(n - 1, 0.05 / (n - 1), (3, 1, 100))
    told = level_frfs([0.0] * 3, n)
    frf = with_variance(replace(told, coherence=1.0 - noise))
    wanted = 4.0 * noise.mean() / (1.0 - noise.mean()) / (n - 1)
    # The larger of a smoothed line and the level around: 15 % too large for two averages.
    assert np.mean(frf.variance) == pytest.approx(wanted, rel=0.25)


def test_it_agrees_with_the_scatter_of_averaged_noise():
    rng = np.random.default_rng(1)
    n, runs = 5, 4000
    force = rng.standard_normal((runs, n)) + 1j * rng.standard_normal((runs, n))
    noise = 0.3 * (rng.standard_normal((runs, n)) + 1j * rng.standard_normal((runs, n)))
    response = 2.0 * force + noise
    cross, power = (response * force.conj()).sum(1), (np.abs(force) ** 2).sum(1)
    H = cross / power
    g = np.abs(cross) ** 2 / (power * (np.abs(response) ** 2).sum(1))
    told = np.mean(np.abs(H) ** 2 * (1 - g) / (g * (n - 1)))
    # 4000 runs of 2 (n - 1) degrees of freedom: 3 sigma is 4 %
    assert told == pytest.approx(np.mean(np.abs(H - 2.0) ** 2), rel=0.06)


def test_unknown_averages_bound_the_variance_as_two_do():
    told, bound = (with_variance(level_frfs([0.9] * 3, n)) for n in (2, 0))
    assert np.array_equal(told.variance, bound.variance)


def test_an_frf_not_measured_stays_so_and_weighs_on_no_other():
    frf = level_frfs([0.9, np.nan, 0.9], 3)
    values, variance = frf.values.copy(), frf.variance.copy()
    values[1], variance[1] = 0.0, np.inf
    hole = with_variance(replace(frf, values=values, variance=variance))
    assert hole.measured.ravel().tolist() == [True, False, True]
    assert np.array_equal(hole.variance[[0, 2]], with_variance(frf).variance[[0, 2]])


def test_points_that_lack_an_frf_are_left_out_with_all_their_axes():
    frf = level_frfs([0.9, 0.9, 0.9], 3)
    z = frf.responses[0].direction
    axes = tuple(Dof(point=p, label=label, direction=z) for p, label in ("1x", "1y", "2x"))
    variance = frf.variance.copy()
    variance[1] = np.inf
    frf = replace(frf, responses=axes, variance=variance)
    assert [dof.point for dof in complete_points(frf).responses] == ["2"]
    variance = variance.copy()
    variance[2] = np.inf
    with pytest.raises(EstimateError, match="every point lacks an FRF"):
        complete_points(replace(frf, variance=variance))


def test_frfs_without_coherence_weigh_like_the_others():
    frf = with_variance(level_frfs([0.9, np.nan, 0.9], 3))
    assert np.allclose(frf.variance[1], frf.variance[0], rtol=1e-6)


@pytest.mark.parametrize(("coherence", "n"), [([np.nan] * 3, 3), ([1.0] * 3, 1)])
def test_without_coherence_or_with_one_average_nothing_is_told(coherence, n):
    assert (with_variance(level_frfs(coherence, n)).variance == 0).all()


def test_a_variance_that_came_with_the_frfs_stays():
    told = level_frfs([0.9, 0.9, 0.9], 3)
    frf = with_variance(replace(told, variance=np.full(told.values.shape, 7.0)))
    assert (frf.variance == 7.0).all()


def test_a_coherence_above_one_is_cut_to_it_once_the_variance_is_known():
    told = level_frfs([0.9, 0.9, 0.9], 3)
    coherence = told.coherence.copy()
    coherence[:, :, ::2] = 1.05
    frf = with_variance(replace(told, coherence=coherence))
    assert frf.coherence.max() == 1.0
    assert (frf.variance > 0.0).all()
