from __future__ import annotations

import numpy as np
import pytest

from armodal.analyzer.modal.spectra import HitSpectra
from armodal.analyzer.modal.usable_band import UsableBand
from armodal.analyzer.ratio_calibration import ratio_calibration
from armodal.protocols.errors import EstimateError

FREQ_HZ = np.arange(1, 301, dtype=np.float64)


def spectra(ratios: list[float], mass_kg: float, bent: float = 0.0) -> HitSpectra:
    """Hits on a mass whose pair of sensors is wrong by `ratios`."""
    force = np.outer(np.arange(1.0, len(ratios) + 1.0), 1.0 / (1.0 + (FREQ_HZ / 200.0) ** 2))
    force = force.astype(np.complex128) * np.exp(-0.02j * FREQ_HZ)
    response = np.zeros((len(ratios), 3, FREQ_HZ.size), dtype=np.complex128)
    shape = 1.0 + bent * FREQ_HZ / FREQ_HZ[-1]
    response[:, 2] = -np.array(ratios)[:, None] * shape * force / mass_kg
    noise = np.zeros(force.shape)
    return HitSpectra(
        freq_hz=FREQ_HZ,
        decay_rad_s=0.0,
        force=force,
        response=response,
        force_noise=noise,
        response_noise=np.zeros(response.shape),
        usable=UsableBand(low_hz=1.0, high_hz=300.0, limit=""),
    )


def test_the_ratio_is_found_whatever_the_hits_and_the_axis_sign():
    found = ratio_calibration(spectra([1.03, 1.03, 1.03], 0.8), 0.8)
    # Sums of a few hundred products: rounding alone.
    assert found.ratio == pytest.approx(1.03, rel=1e-12)
    assert found.unevenness < 1e-12
    assert found.axis == 2


def test_the_scatter_of_the_hits_and_the_mass_make_the_uncertainty():
    found = ratio_calibration(spectra([0.99, 1.0, 1.01], 1.0), 1.0, mass_std_kg=0.002)
    assert found.ratio_std == pytest.approx(np.hypot(0.01 / np.sqrt(3.0), 0.002), rel=1e-9)


def test_one_hit_has_no_known_uncertainty():
    assert np.isinf(ratio_calibration(spectra([1.0], 1.0), 1.0).ratio_std)


def test_a_mass_that_is_not_rigid_shows():
    assert ratio_calibration(spectra([1.0, 1.0], 1.0, bent=0.2), 1.0).unevenness > 0.05


def test_a_mass_of_nothing_is_refused():
    with pytest.raises(EstimateError, match="wanted above 0 kg"):
        ratio_calibration(spectra([1.0], 1.0), 0.0)
