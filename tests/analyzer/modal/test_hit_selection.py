from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from armodal.analyzer.modal.hit_selection import coherence_of_all, select_hits
from armodal.protocols.errors import EstimateError

FREQ_HZ = np.linspace(3.0, 100.0, 80)


def frf(shares=(1.0, 0.5, 0.2)):
    """Accelerance of three modes on two axes."""
    w = 2 * np.pi * FREQ_HZ
    modes = [-(w**2) / (w0**2 - w**2 + 0.06j * w0 * w) for w0 in 2 * np.pi * np.array([12, 37, 66])]
    first = sum(share * mode for share, mode in zip(shares, modes, strict=True))
    return np.stack([first, 0.5 * modes[0] - 0.4 * modes[2]])


def aim_errors(rng, n, size=0.02):
    """One complex number a hit, common to all lines and axes: the worst case of the test."""
    number = rng.standard_normal(n) + 1j * rng.standard_normal(n)
    return size * number[:, None, None] * frf((0.3, -1.0, 0.7))


def line_errors(rng, n, size=0.02):
    noise = rng.standard_normal((2, n, 2, len(FREQ_HZ)))
    return size * np.abs(frf()) * (noise[0] + 1j * noise[1])


@pytest.mark.parametrize("n", [5, *(pytest.param(n, marks=pytest.mark.long) for n in (6, 8))])
@pytest.mark.parametrize("errors", [aim_errors, line_errors])
def test_good_hits_are_seldom_called_unlike(n, errors):
    rng = np.random.default_rng(1)
    trials = 100
    dropped = sum(bool(select_hits(frf() + errors(rng, n), FREQ_HZ).dropped) for _ in range(trials))
    # 1 % is asked for; the procedure's own bound is that for each of up to three outliers.
    assert dropped <= stats.binom.ppf(0.9999, trials, 0.03)


@pytest.mark.parametrize("errors", [aim_errors, line_errors])
def test_two_askew_hits_of_seven_are_found_and_said_to_be_so(errors):
    rng = np.random.default_rng(2)
    trials, others = 60, 0
    for _ in range(trials):
        frfs = frf() + errors(rng, 7, 0.005)
        frfs[[1, 4]] *= 0.8
        selection = select_hits(frfs, FREQ_HZ)
        askew = [d for d in selection.dropped if d.hit in {1, 4}]
        assert [d.reason for d in askew] == ["unlike", "unlike"]
        assert all("times those of the others" in d.note for d in askew)
        assert selection.variance_factor == 1.0
        others += len(selection.dropped) > 2
    # 1 % is asked for, and the procedure's own bound of three outliers is three times that.
    assert others <= stats.binom.ppf(0.9999, trials, 0.03)


def test_a_hit_that_differs_in_shape_is_told_where():
    rng = np.random.default_rng(3)
    frfs = frf() + line_errors(rng, 6, 0.005)
    frfs[2] = frf((1.0, 0.8, 0.2))
    (dropped,) = select_hits(frfs, FREQ_HZ).dropped
    assert dropped.hit == 2
    assert "axis 1" in dropped.note
    # Its second mode, at 37 Hz, differs; the band of a mode of 3 % damping is 2 Hz wide.
    place = float(dropped.note.split(" most at ")[1].split(" Hz")[0])
    assert place == pytest.approx(37.0, abs=8.0)


def test_three_hits_are_too_few_to_accuse_one():
    frfs = np.stack([frf(), frf() * 1.001, frf() * 2.0])
    selection = select_hits(frfs, FREQ_HZ)
    assert selection.kept == (0, 1, 2)
    assert selection.note.startswith("cannot tell")


def test_surplus_hits_are_the_farthest_from_the_mean():
    frfs = frf() * np.array([1.0, 1.01, 0.99, 1.03, 0.995])[:, None, None]
    selection = select_hits(frfs, FREQ_HZ, keep=3, false_drop=1e-9)
    # The mean is 1.005: 1.0, 1.01 and 0.995 are the nearest.
    assert selection.kept == (0, 1, 4)
    assert {d.hit: d.reason for d in selection.dropped} == {2: "surplus", 3: "surplus"}


@pytest.mark.long
@pytest.mark.parametrize(
    ("n", "keep"), [(5, 4), *(pytest.param(n, 3, marks=pytest.mark.long) for n in (4, 6))]
)
def test_the_factor_makes_up_for_choosing(n, keep):
    rng = np.random.default_rng(4)
    trials = 600
    stated, mean_squared = np.empty(trials), np.empty(trials)
    for k in range(trials):
        errors = (rng.standard_normal((n, 1, 1)) + 1j * rng.standard_normal((n, 1, 1))) / 2**0.5
        selection = select_hits(errors, [1.0], keep=keep, false_drop=1e-9)
        kept = errors[list(selection.kept)]
        stated[k] = selection.variance_factor * kept.var(ddof=1) / keep
        mean_squared[k] = np.abs(kept.mean()) ** 2
    # The variance stated for the mean of the kept is never below its true one; both are means of
    # nearly exponential values, relative standard error 1/sqrt(trials) each.
    assert stated.mean() >= mean_squared.mean() * (1.0 - 4.0 * (2.0 / trials) ** 0.5)
    # A good hit's scatter is 1: without the choice's 5/4, the stated scatter is without bias.
    assert keep * stated.mean() / 1.25 == pytest.approx(1.0, rel=4.0 * trials**-0.5)


def test_coherence_of_all_undoes_the_scatter_factor():
    # Noise over signal of 0.01 among the kept, three times that of a hit.
    assert coherence_of_all(np.array(1 / 1.01), 3.0) == pytest.approx(1 / 1.03, rel=1e-12)


@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_units_do_not_matter(factor):
    rng = np.random.default_rng(5)
    frfs = frf() + line_errors(rng, 6)
    one, other = (select_hits(f, FREQ_HZ, keep=4) for f in (frfs, factor * frfs))
    assert one.kept == other.kept
    np.testing.assert_allclose(one.distance, other.distance, rtol=1e-9)  # rounding


def test_identical_hits_are_all_kept():
    selection = select_hits(np.stack([frf()] * 5), FREQ_HZ)
    assert selection.kept == (0, 1, 2, 3, 4)


@pytest.mark.parametrize(
    ("frfs", "settings", "word"),
    [
        (np.zeros((2, 3)), {}, "n_hits, n_axes, n_freq"),
        (np.zeros((0, 1, 80)), {}, "n_hits, n_axes, n_freq"),
        (np.full((4, 1, 80), np.nan), {}, "finite"),
        (np.ones((4, 1, 80)), {"keep": 0}, "keep"),
        (np.ones((4, 1, 80)), {"false_drop": 1.0}, "false_drop"),
    ],
)
def test_what_cannot_be_selected_from_is_refused(frfs, settings, word):
    with pytest.raises(EstimateError, match=word):
        select_hits(frfs, FREQ_HZ, **settings)
