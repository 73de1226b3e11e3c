"""A mode whose frequency is less well known than it is wide has no place."""

from dataclasses import replace

import numpy as np
import pytest
from support.simulated_frfs import eight_modes, modal_frf, noisy_record, poles_of

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.modal.places import without_place
from armodal.protocols.frf_records import FrfForm

LINE_HZ = 0.25


@pytest.fixture(scope="module")
def mode():
    """The fourth of eight, 34 Hz."""
    return fit_modes(eight_modes(np.random.default_rng(3)).frf).modes[3]


@pytest.mark.parametrize(
    ("half_bandwidths", "damping_known", "gone"),
    [(1.5, True, False), (2.5, True, True), (0.5, False, False), (1.5, False, True)],
)
def test_a_mode_known_to_no_better_than_its_width_goes(mode, half_bandwidths, damping_known, gone):
    half = mode.damping_ratio * mode.f_hz
    told = replace(
        mode,
        f_std_hz=half_bandwidths * half + 2.0 * LINE_HZ,
        damping_std=mode.damping_ratio * (0.3 if damping_known else 1.2),
    )
    assert without_place([mode, told], LINE_HZ).tolist() == [False, gone]


def test_a_resonance_narrower_than_a_line_is_placed_by_lines(mode):
    narrow = replace(mode, damping_ratio=1e-6, damping_std=1e-5, f_std_hz=LINE_HZ)
    assert not without_place([narrow], LINE_HZ)[0]
    assert without_place([narrow], 0.1 * LINE_HZ)[0]


def test_no_mode_of_a_fit_is_without_place():
    rng = np.random.default_rng(6)
    poles = poles_of([20.0, 60.0], [0.02, 0.2])  # the second is next to nothing
    shapes = np.array([1.0, 2e-3])[:, None, None] * rng.standard_normal((2, 4, 1))
    freq = LINE_HZ * np.arange(20, 500)
    clean = modal_frf(poles, shapes / (2j * poles.imag[:, None, None]), freq, FrfForm.ACCELERANCE)
    frf = noisy_record(rng, clean, freq, form=FrfForm.ACCELERANCE, level=0.02)
    model = fit_modes(frf)
    assert len(model.modes) == 1
    assert not np.any(without_place(model.modes, LINE_HZ))
