"""Two hammers merged: never worse than either, honest where they agree and where they do not."""

import dataclasses
from functools import cache

import numpy as np
import pytest
from support import hammer
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal import coherence_random_error, posture_frf
from armodal.analyzer.modal.merge import merge_frfs
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfForm

POLES = poles_of([11.0, 38.0, 79.0], [0.03, 0.025, 0.02])
N_POINTS = 2


def axes(_point):
    return np.eye(3)


def residues():
    rng = np.random.default_rng(4)
    return 0.3 * rng.standard_normal((3, N_POINTS, 3)) / (2j * POLES.imag[:, None, None])


def frf_of(seed, width_s, *, band_hz, hits=5, noise=0.05, **settings):
    """FRFs of a hammer whose pulse is as wide; white noise on every channel."""
    session = hammer.session(
        POLES,
        settings.pop("residues", residues()),
        rng=np.random.default_rng(seed),
        widths_s=(width_s, width_s),
        hits=hits,
        noise=noise,
        anti_alias=True,
        exponential_end=0.001,
        **settings,
    )
    return posture_frf(session, "p", axes, band_hz=band_hz)


@cache
def two_hammers(seed, **settings):
    soft = frf_of(2 * seed, 12e-3, band_hz=(3.0, 120.0), **settings)
    hard = frf_of(2 * seed + 1, 4e-3, band_hz=(5.0, 150.0), **settings)
    return soft, hard


def truth(frf):
    return modal_frf(
        POLES,
        residues().reshape(3, -1, 1),
        frf.freq_hz,
        FrfForm.ACCELERANCE,
        frf.decay_rad_s,
    )


def on(frf, freq_hz):
    """Variance on other lines; infinite where there is none."""
    result = np.full((*frf.values.shape[:2], freq_hz.size), np.inf)
    at = np.searchsorted(freq_hz, frf.freq_hz - 1e-6)
    result[..., at] = frf.variance
    return result


def test_the_merged_variance_is_never_above_either_on_any_line():
    for seed in range(6):
        soft, hard = two_hammers(seed)
        merged = merge_frfs([soft, hard])
        assert merged.disagreements == ()
        freq = merged.frf.freq_hz
        assert (freq[0], freq[-1]) == (soft.freq_hz[0], hard.freq_hz[-1])
        least = np.minimum(on(soft, freq), on(hard, freq))
        assert (merged.frf.variance <= least).all()
        # Where both are worth the same it is half of either.
        assert (merged.frf.variance / least).min() < 0.6


def test_the_merged_error_is_what_its_variance_says():
    ratio: list[np.ndarray] = []
    alone: list[list[float]] = []
    for seed in range(10):
        soft, hard = two_hammers(seed)
        merged = merge_frfs([soft, hard]).frf
        ratio.append(np.abs(merged.values - truth(merged)) ** 2 / merged.variance)
        each = [np.abs(one.values - truth(one)) ** 2 / one.variance for one in (soft, hard)]
        alone.append([float(np.mean(one)) for one in each])
    ratio = np.stack(ratio)
    # A complex normal error is within 3 of its mean square in 95 %. The window makes neighbouring
    # lines alike: 10 seeds x 6 FRFs x some 40 independent lines, 2400 of them, leave 0.5 %; what
    # the smoothed scatter makes of a single hammer is the measure of the rest.
    assert np.mean(ratio < 3.0) == pytest.approx(0.95, abs=0.035)
    low, high = sorted(np.mean(alone, axis=0))
    assert low - 0.05 < np.mean(ratio) < high + 0.05


def test_a_weight_is_what_the_random_error_from_coherence_says():
    soft, hard = two_hammers(1, noise=0.2)
    merged = merge_frfs([soft, hard])
    shared = np.isin(np.round(merged.frf.freq_hz, 4), np.round(hard.freq_hz, 4))
    shared &= merged.frf.freq_hz <= soft.freq_hz[-1]
    freq = merged.frf.freq_hz[shared]
    errors = []
    for frf in (soft, hard):
        at = np.isin(np.round(frf.freq_hz, 4), np.round(freq, 4))
        relative = coherence_random_error(frf.coherence[0, 0, at], 5)
        errors.append((relative * np.abs(frf.values[0, 0, at])) ** 2)
    wanted = errors[1] / (errors[0] + errors[1])  # weight of the soft one
    got = merged.weight[0, 0, 0, shared]
    # The coherence of five hits of one line is rough; over the band both tell the same.
    assert np.mean(got) == pytest.approx(np.mean(wanted), abs=0.08)
    assert np.corrcoef(got, wanted)[0, 1] > 0.3


def test_the_merged_coherence_says_the_merged_variance():
    merged = merge_frfs(two_hammers(3)).frf
    n = merged.n_hits[..., None]
    told = np.abs(merged.values) ** 2 * (1 - merged.coherence) / (merged.coherence * (n - 1))
    np.testing.assert_allclose(told, merged.variance, rtol=1e-6)  # 1 - g^2
    assert (merged.n_hits == 10).all()


def test_another_sensitivity_is_said_and_the_deviation_covers_both():
    soft, hard = two_hammers(2)
    hard = dataclasses.replace(hard, values=1.1 * hard.values)
    merged = merge_frfs([soft, hard])
    assert merged.disagreements
    for told in merged.disagreements:
        assert abs(told.gain) == pytest.approx(1.1, abs=0.02)
    found = {(told.response, told.reference) for told in merged.disagreements}
    strong = [i for i in range(6) if (i, 0) in found]
    frf = merged.frf
    error = np.abs(frf.values - truth(frf))[strong]
    # Within 2.5 deviations of one part of a complex number lies the truth, 5 % off, of most lines.
    assert np.mean(error < 2.5 * np.sqrt(frf.variance[strong])) > 0.95


def test_a_structure_that_changed_is_said_where_it_did():
    soft, _ = two_hammers(5)
    moved = POLES * np.array([1.0, 1.02, 1.0])
    session = hammer.session(
        moved,
        residues(),
        rng=np.random.default_rng(6),
        widths_s=(4e-3, 4e-3),
        hits=5,
        noise=0.05,
        anti_alias=True,
        exponential_end=0.001,
    )
    hard = posture_frf(session, "p", axes, band_hz=(5.0, 150.0))
    merged = merge_frfs([soft, hard])
    assert merged.disagreements
    for told in merged.disagreements:
        assert told.low_hz < 38.5
        assert told.high_hz > 38.0
    frf = merged.frf
    near = (frf.freq_hz > 35.0) & (frf.freq_hz < 41.0)
    there = [told.response for told in merged.disagreements]
    both = np.minimum(on(soft, frf.freq_hz), on(hard, frf.freq_hz))
    assert (frf.variance[there][..., near] > both[there][..., near]).any()


def test_frfs_that_agree_are_hardly_ever_said_to_differ():
    # Every hit reaches every mode differently by 2 %: what is common to many lines is no news.
    said = sum(bool(merge_frfs(two_hammers(seed, aim=0.02)).disagreements) for seed in range(6))
    assert said == 0  # 1 % each


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"form": FrfForm.MOBILITY}, "one form"),
        ({"decay_rad_s": 0.0}, "one exponential window"),
    ],
)
def test_frfs_of_another_kind_are_refused(change, words):
    soft, hard = two_hammers(0)
    with pytest.raises(EstimateError, match=words):
        merge_frfs([soft, dataclasses.replace(hard, **change)])


def test_frfs_without_variance_or_on_other_lines_or_points_are_refused():
    soft, hard = two_hammers(0)
    silent = dataclasses.replace(hard, variance=np.zeros_like(hard.variance))
    with pytest.raises(EstimateError, match="wanted a variance"):
        merge_frfs([soft, silent])
    other = dataclasses.replace(hard, freq_hz=1.3 * hard.freq_hz)
    with pytest.raises(EstimateError, match="same lines"):
        merge_frfs([soft, other])
    elsewhere = tuple(dataclasses.replace(dof, point="9") for dof in hard.references)
    with pytest.raises(EstimateError, match="same points"):
        merge_frfs([soft, dataclasses.replace(hard, references=elsewhere)])


def test_a_point_that_one_has_not_is_the_other_s_alone():
    soft, hard = two_hammers(0)
    fewer = dataclasses.replace(
        hard,
        responses=hard.responses[:3],
        values=hard.values[:3],
        variance=hard.variance[:3],
        coherence=hard.coherence[:3],
        n_hits=hard.n_hits[:3],
    )
    merged = merge_frfs([soft, fewer]).frf
    # No line of the matrix lacks an FRF: the lines end with the soft hammer's.
    assert merged.freq_hz[-1] == soft.freq_hz[-1]
    np.testing.assert_array_equal(merged.values[3:], soft.values[3:])
    assert (merged.n_hits[:, 0] == [10, 10, 10, 5, 5, 5]).all()
