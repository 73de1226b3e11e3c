"""Stated standard deviations of modes against their scatter where few points move."""

from __future__ import annotations

import numpy as np
import pytest
from support.simulated_frfs import modal_frf, poles_of, record

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.uncertainty import white_covariance
from armodal.protocols.frf_records import FrfForm

FREQ_HZ = np.arange(5.0, 60.0, 0.5)
POLES = poles_of([14.9, 34.0], [0.03, 0.025])
LEVEL = 0.001  # of the rms of the point that moves most


def noisy_points(rng, motion):
    """FRFs of a point for each factor of `motion` (n_points, n_modes), noise alike on all."""
    shapes = np.array([[1.0, -0.4, 0.7], [0.3, 0.8, -0.6]])
    residues = (motion[:, :, None] * shapes).transpose(1, 0, 2).reshape(2, -1, 1)
    residues = residues / (2j * POLES.imag[:, None, None])
    from_modes = modal_frf(POLES, residues, FREQ_HZ, FrfForm.ACCELERANCE)
    sigma = LEVEL * np.sqrt(np.mean(np.abs(from_modes[:3]) ** 2))
    noise = rng.standard_normal((2, *from_modes.shape)) / np.sqrt(2.0)
    return record(
        from_modes + sigma * (noise[0] + 1j * noise[1]),
        FREQ_HZ,
        variance=np.full(from_modes.shape, sigma**2),
        axes=3,
    )


@pytest.mark.long
@pytest.mark.parametrize(
    "motion",
    [
        np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]]),  # two on the base
        np.array([[1.0, 1.0], [1e-3, 1e-3], [3e-4, 1e-3], [1e-3, 3e-4]]),
        np.array([[1.0, 1.0], [0.8, 0.0], [0.6, 0.0], [0.7, 0.0]]),  # one mode at one point
    ],
)
def test_the_stated_std_is_the_scatter_where_one_point_holds_the_information(motion):
    found, stated = [], []
    for seed in range(24):
        model = fit_modes(noisy_points(np.random.default_rng(seed), motion), max_order=24)
        assert len(model.modes) == 2
        found.append([(m.f_hz, m.damping_ratio) for m in model.modes])
        stated.append([(m.f_std_hz, m.damping_std) for m in model.modes])
    ratio = np.median(stated, axis=0) / np.std(found, axis=0, ddof=1)
    # The scatter of 24 runs is known to 15 %: three times that, where three points see the mode by
    # the clusters' few degrees of freedom too.
    assert np.all((ratio > 0.6) & (ratio < 1.6)), ratio


def test_dead_points_beside_one_that_moves_leave_the_std_as_it_is():
    rng = np.random.default_rng(1)
    frf = noisy_points(rng, np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]]))
    dead = frf.values.copy()
    dead[3:] = 0.0
    of_one = record(frf.values[:3], FREQ_HZ, variance=frf.variance[:3], axes=3)
    alone = fit_modes(of_one, max_order=24)
    for variance in (frf.variance, np.where(dead == 0.0, 0.0, frf.variance)):
        beside = fit_modes(record(dead, FREQ_HZ, variance=variance, axes=3), max_order=24)
        for mode, own in zip(beside.modes, alone.modes, strict=True):
            # A dead channel fits itself exactly: of nine FRFs three leave a misfit, which is
            # averaged over all, so that the std falls by a factor of up to sqrt(3).
            assert own.f_std_hz / 1.8 < mode.f_std_hz < 1.8 * own.f_std_hz
            assert np.isfinite(mode.shape_std).all()


@pytest.mark.parametrize("left", [0.0, -1e-17, 1e-320])
def test_a_parameter_without_information_leaves_the_others_as_they_are(left):
    """What rounding leaves of it after a projection is scaled by nothing: no overflow."""
    rng = np.random.default_rng(3)
    root = rng.standard_normal((3, 3)) * np.array([1e-6, 1.0, 1e6])
    known = root.T @ root
    information = np.zeros((4, 4))
    information[1:, 1:] = known
    information[0, 0] = left
    information[0, 2] = information[2, 0] = left
    covariance = white_covariance(information, 0.5, 1.0)
    own = np.sqrt(np.diag(known))
    unit = np.linalg.inv(known / np.outer(own, own)) / np.outer(own, own)
    # An inverse is good to machine epsilon times the condition, below 1e3 once scaled.
    np.testing.assert_allclose(covariance[1:, 1:], 0.5 * unit, rtol=1e-10)
    assert np.all(covariance[0] == 0.0)
