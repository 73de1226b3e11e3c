import numpy as np
import pytest
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import modal_data, regress
from armodal.analyzer.modal.significance import lack_of_fit
from armodal.analyzer.modal.uncertainty import frequency_damping_jacobian
from armodal.protocols.frf_records import FrfForm

FREQ = np.arange(5.0, 60.0, 0.5)
POLES = poles_of([12.0, 30.0], [0.03, 0.02])


def data(*, shared, noise=0.02, seed=0):
    rng = np.random.default_rng(seed)
    residues = rng.standard_normal((2, 6, 1)) / (2j * POLES.imag[:, None, None])
    clean = modal_frf(POLES, residues, FREQ, FrfForm.RECEPTANCE)
    sigma = noise * np.abs(clean).mean() * np.ones(clean.shape)
    if not shared:
        sigma = sigma * rng.uniform(0.5, 2.0, clean.shape)
    error = rng.standard_normal((2, *clean.shape)) / np.sqrt(2.0)
    values = clean + sigma * (error[0] + 1j * error[1])
    return modal_data(FrfForm.RECEPTANCE, 2j * np.pi * FREQ, values, sigma**2)


@pytest.mark.parametrize("shared", [True, False])
def test_score_is_minus_half_the_gradient_of_the_cost(shared):
    frfs = data(shared=shared)
    poles = POLES * 1.002
    fit = regress(frfs, poles)
    step = 1e-4 * np.abs(poles.real)
    for m in range(2):
        for part, direction in enumerate((1.0, 1j)):
            shift = np.zeros(2, complex)
            shift[m] = step[m] * direction
            rise = regress(frfs, poles + shift).cost.sum() - regress(frfs, poles - shift).cost.sum()
            gradient = rise / (2.0 * step[m])
            # Central difference: relative error of the order of the step squared, and rounding.
            np.testing.assert_allclose(
                fit.score.sum(axis=0)[2 * m + part], -0.5 * gradient, rtol=1e-4
            )


def test_gain_of_a_mode_is_the_rise_of_the_cost_without_it():
    frfs = data(shared=False)
    both, one = regress(frfs, POLES), regress(frfs, POLES[:1])
    np.testing.assert_allclose(one.cost - both.cost, both.gain[:, 1], rtol=1e-6)  # Gram rounding


def test_shared_weights_give_what_separate_ones_do():
    frfs = data(shared=True)
    assert frfs.weight.shape[0] == 1
    split = modal_data(
        frfs.form, frfs.s, frfs.values, 1.0 / (frfs.row_weight[:, None] * frfs.weight)
    )
    wide = regress(split, POLES)
    np.testing.assert_allclose(regress(frfs, POLES).residues, wide.residues, rtol=1e-9)


def test_refinement_comes_to_rest_from_two_starts_at_one_place():
    frfs = data(shared=False)
    first = refine_poles(frfs, POLES * 1.004)
    second = refine_poles(frfs, POLES * 0.996)
    # It stops when no pole moves by 1e-5 of its half bandwidth.
    assert np.all(np.abs(first.poles - second.poles) < 1e-4 * np.abs(POLES.real))


def test_frequency_damping_jacobian_is_the_derivative():
    def quantities(p):
        return np.stack([np.abs(p) / (2.0 * np.pi), -p.real / np.abs(p)], axis=1).ravel()

    J = frequency_damping_jacobian(POLES)
    for column in range(4):
        shift = np.zeros(2, complex)
        shift[column // 2] = 1e-3 * (1.0, 1j)[column % 2]
        slope = (quantities(POLES + shift) - quantities(POLES - shift)) / 2e-3
        np.testing.assert_allclose(J[:, column], slope, rtol=1e-5, atol=1e-12)  # step squared


def test_noise_of_the_stated_variance_leaves_half_a_misfit_a_degree_of_freedom():
    """On few lines, where the parameters take a third of the freedom."""
    few = slice(20, 80, 5)
    found = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        residues = rng.standard_normal((2, 6, 1)) / (2j * POLES.imag[:, None, None])
        clean = modal_frf(POLES, residues, FREQ[few], FrfForm.RECEPTANCE)
        sigma = 1e-3 * np.abs(clean).mean() * np.ones(clean.shape)
        error = rng.standard_normal((2, *clean.shape)) / np.sqrt(2.0)
        values = clean + sigma * (error[0] + 1j * error[1])
        s = 2j * np.pi * FREQ[few]
        fit = refine_poles(modal_data(FrfForm.RECEPTANCE, s, values, sigma**2), POLES)
        found.append(lack_of_fit(fit, s.size))
    # 60 draws of 6 (24 - 4 - 3) - 4 = 98 degrees of freedom: three deviations are 5.5 %.
    assert np.mean(found) == pytest.approx(0.5, rel=0.055)
