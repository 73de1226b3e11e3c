"""Weights from coherences as files hold them: clipped, rounded, above one, of few averages."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student
from support.averaged_frfs import averaged
from support.quick import few_quick

from armodal.analyzer.coherence_noise import coherence_noise
from armodal.analyzer.given_frfs import with_variance
from armodal.analyzer.modal import fit_modes

HARMS = {
    "8 bit": lambda g, _: np.round(g * 255) / 255,
    "5 bit": lambda g, _: np.round(g * 31) / 31,
    "clipped at 0.99": lambda g, _: np.where(g > 0.99, 1.0, g),
    "2 % off": lambda g, rng: g + 0.02 * rng.normal(size=g.shape),
    "2 % off, clipped": lambda g, rng: np.minimum(g + 0.02 * rng.normal(size=g.shape), 1.0),
    "all one": lambda g, _: np.ones_like(g),
    "as it is": lambda g, _: g,
}
HOW = list(HARMS)


def fitted(how, n_averages, seed):
    rng = np.random.default_rng(seed)
    made = averaged(rng, n_averages)
    frf = replace(made.frf, coherence=HARMS[how](made.frf.coherence, rng))
    modes = fit_modes(with_variance(frf)).modes
    return [min(modes, key=lambda mode: abs(mode.f_hz - f)) for f in made.f_hz], made.f_hz


@pytest.mark.long
@pytest.mark.parametrize("n_averages", [2, 5])
@pytest.mark.parametrize("how", HOW)
def test_the_stated_deviation_covers_the_truth(how, n_averages):
    """Of 180 modes, 95 % nominal: 90 to 98 % of the task, and 2 % of binomial scatter about it."""
    inside = [
        abs(mode.f_hz - f) < student.ppf(0.975, mode.dof) * mode.f_std_hz
        for seed in range(60)
        for mode, f in zip(*fitted(how, n_averages, seed), strict=True)
    ]
    assert 0.88 < np.mean(inside) < 0.99


@pytest.mark.parametrize("how", few_quick(HOW[:5], HOW[0], HOW[4]))
def test_a_poor_coherence_costs_no_precision(how):
    """Deviations are near those of the true variance; its face value would cost a factor of 4."""
    rng = np.random.default_rng(3)
    made = averaged(rng, 5)
    best = fit_modes(replace(made.frf, variance=made.variance)).modes
    modes, _ = fitted(how, 5, 3)
    for mode, wanted in zip(modes, best, strict=True):
        assert mode.f_std_hz < 1.3 * wanted.f_std_hz


@pytest.mark.parametrize("how", HOW[:5])
@pytest.mark.parametrize("n_averages", [2, 5, 30])
def test_the_noise_level_is_that_of_the_lines_that_tell_it(how, n_averages):
    rng = np.random.default_rng(n_averages)
    made = averaged(rng, n_averages)
    coherence = HARMS[how](made.frf.coherence, rng)
    for i in range(len(coherence)):
        size = np.abs(made.frf.values[i, 0]) ** 2
        found = coherence_noise(size, coherence[i, 0], n_averages)
        # Without these weights the level at resonances is wrong by 1000 and more.
        ratio = found.level / made.variance[i, 0]
        assert ratio.min() > 0.2
        assert ratio.max() < 5.0


def test_what_reads_one_on_every_line_tells_nothing():
    assert coherence_noise(np.ones(100), np.ones(100), 5) is None
    assert coherence_noise(np.ones(100), np.full(100, 1.05), 5) is None


def test_one_average_tells_nothing():
    assert coherence_noise(np.ones(100), np.full(100, 0.9), 1) is None


@pytest.mark.parametrize("n_averages", [2, 3, 10])
def test_a_coherence_of_few_averages_is_not_biased(n_averages):
    """Pure noise reads 1 / n; the noise over force it tells is right all the same."""
    rng = np.random.default_rng(n_averages)
    n = 4000
    parts = rng.normal(size=(2, n_averages, n)) / np.sqrt(2.0)
    noise = parts[0] + 1j * parts[1]
    response = 0.5 + noise  # force 1
    H = response.mean(0)
    coherence = np.abs(H) ** 2 / (np.abs(response) ** 2).mean(0)
    found = coherence_noise(np.abs(H) ** 2, coherence, n_averages)
    # 4000 lines of n - 1 complex degrees of freedom: 3 deviations are 5 % for two averages.
    assert np.mean(found.scatter) == pytest.approx(1.0 / n_averages, rel=0.06)
    assert np.median(found.level) == pytest.approx(1.0 / n_averages, rel=0.15)


def test_numbers_of_lines_that_fit_no_window_do():
    for n in (8, 9, 40, 41, 42, 200, 337):
        coherence = 1.0 - 0.01 * np.linspace(0.5, 1.5, n)
        found = coherence_noise(np.ones(n), coherence, 3)
        assert found.level.shape == found.scatter.shape == (n,)
        assert np.isfinite(found.level).all()
        assert (found.level > 0.0).all()
