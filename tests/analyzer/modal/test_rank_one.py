from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import t as student
from support.simulated_frfs import cramer_rao_std, eight_modes, modal_frf, noisy_record, poles_of

from armodal.analyzer.modal import fit_modes, mac
from armodal.analyzer.modal.correlation import to_real_axis
from armodal.analyzer.modal.rank_one import refine_rank_one
from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import modal_data, residual_terms
from armodal.analyzer.modal.shape_uncertainty import participation_covariance
from armodal.protocols.frf_records import FrfForm

FREQ = np.arange(5.0, 60.0, 0.5)
POLES = poles_of([12.0, 30.0, 31.0], [0.03, 0.02, 0.02])


def made(rng, *, shared, n_resp=6, n_ref=3, level=0.02):
    participation = rng.standard_normal((2, 3, 1, n_ref))
    shapes = rng.standard_normal((3, n_resp, 1))
    residues = (
        shapes * (participation[0] + 1j * participation[1]) / (2j * POLES.imag[:, None, None])
    )
    clean = modal_frf(POLES, residues, FREQ, FrfForm.RECEPTANCE)
    frf = noisy_record(rng, clean, FREQ, form=FrfForm.RECEPTANCE, level=level)
    variance = frf.variance * (1.0 if shared else rng.uniform(0.8, 1.2, clean.shape))
    data = modal_data(FrfForm.RECEPTANCE, 2j * np.pi * FREQ, frf.values, variance)
    return data, residues, frf.values, variance


def cost_of(data, poles, participation, values, variance):
    """Weighted misfit at best shapes and residual terms, by plain least squares on all lines."""
    s = data.s
    total = 0.0
    n_resp, n_ref, _ = values.shape
    weight = 1.0 / np.sqrt(variance)
    residual = residual_terms(data.form, s).T
    residual = residual / np.linalg.norm(residual, axis=1, keepdims=True)
    for o in range(n_resp):
        columns = []
        for m, pole in enumerate(poles):
            direct, mirrored = 1.0 / (s - pole), 1.0 / (s - np.conj(pole))
            columns.extend(
                [
                    factor * participation[j, m] * direct
                    + np.conj(factor * participation[j, m]) * mirrored
                    for j in range(n_ref)
                ]
                for factor in (1.0, 1j)
            )
        columns.extend(
            [term if i == j else 0.0 * term for i in range(n_ref)]
            for j in range(n_ref)
            for term in residual
        )
        A = np.array([(np.array(c) * weight[o]).ravel() for c in columns]).T
        b = (values[o] * weight[o]).ravel()
        A, b = np.vstack([A.real, A.imag]), np.concatenate([b.real, b.imag])
        A = A / np.linalg.norm(A, axis=0)
        total += np.sum((b - A @ np.linalg.lstsq(A, b, rcond=None)[0]) ** 2)
    return total


@pytest.mark.parametrize("shared", [True, False])
def test_cost_is_that_of_plain_least_squares_and_least_in_every_direction(shared):
    rng = np.random.default_rng(0)
    data, _, values, variance = made(rng, shared=shared)
    start = refine_poles(data, POLES)
    fit = refine_rank_one(data, start.poles, start.residues.reshape(6, 3, 3), tolerance=1e-8)
    best = cost_of(data, fit.poles, fit.participation, values, variance)
    assert fit.cost.sum() == pytest.approx(best, rel=1e-8)  # Gram rounding
    for _ in range(5):
        d_pole = 1e-4 * np.abs(POLES.real) * (rng.standard_normal(3) + 1j * rng.standard_normal(3))
        d_part = 1e-3 * rng.standard_normal(fit.participation.shape)
        assert (
            cost_of(data, fit.poles + d_pole, fit.participation + d_part, values, variance) > best
        )


def test_shared_shapes_leave_less_error_than_free_residues():
    free, bound = [], []
    for seed in range(20):
        data, residues, _, _ = made(np.random.default_rng(seed), shared=True)
        start = refine_poles(data, POLES)
        fit = refine_rank_one(data, start.poles, start.residues.reshape(6, 3, 3))
        truth = residues.transpose(1, 2, 0)
        free.append(np.linalg.norm(start.residues.reshape(6, 3, 3) - truth))
        bound.append(np.linalg.norm(fit.shape[:, None] * fit.participation - truth))
    # Eight complex numbers a mode instead of eighteen: the error goes with the square root.
    assert np.mean(bound) < 0.85 * np.mean(free)


# Of n draws 16 n errors: four deviations of their root mean square above one.
@pytest.mark.parametrize(
    ("n_ref", "draws", "most"),
    [
        (2, 2, 1.5),
        pytest.param(2, 6, 1.3, marks=pytest.mark.long),
        pytest.param(3, 6, 1.3, marks=pytest.mark.long),
    ],
)
def test_several_references_reach_the_bound_of_all_of_them(n_ref, draws, most):
    scaled = []
    for seed in range(draws):
        truth = eight_modes(np.random.default_rng(seed), n_resp=12, n_ref=n_ref)
        model = fit_modes(truth.frf)
        assert len(model.modes) == 8
        error = np.stack(
            [
                model.f_hz - np.abs(truth.poles) / (2.0 * np.pi),
                model.damping_ratio + truth.poles.real / np.abs(truth.poles),
            ],
            axis=1,
        )
        scaled.append(error / cramer_rao_std(truth))
        for mode, residue in zip(model.modes, truth.residues, strict=True):
            for found, std, of_truth in (
                (mode.shape, mode.shape_std, residue[:, 0]),
                (mode.participation, mode.participation_std, residue[0]),
            ):
                # What a MAC is below one by is the error's square; a reference's two numbers
                # exceed ten times what is stated once in e^10.
                stated = np.linalg.norm(std) / np.linalg.norm(found)
                assert 1.0 - mac(found, of_truth) < 10.0 * stated**2
    assert np.sqrt(np.mean(np.square(scaled))) < most


# Of n draws 46 n and 6 n intervals of nominal 95 %: four deviations of a quarter's smaller share.
@pytest.mark.long
@pytest.mark.parametrize(
    ("draws", "low", "high"),
    [(25, 0.88, 0.99), (100, 0.9, 0.98)],
)
def test_stated_shape_deviations_cover(draws, low, high):
    poles = poles_of([12.0, 14.0], [0.03, 0.03])
    inside, sides = [], []
    for seed in range(draws):
        rng = np.random.default_rng(seed)
        shapes = rng.standard_normal((2, 12, 1))
        participation = rng.uniform(0.3, 1.0, (2, 1, 2)) * [[[1.0, 1.0]], [[1.0, -1.0]]]
        residues = shapes * participation / (2j * poles.imag[:, None, None])
        clean = modal_frf(poles, residues, FREQ, FrfForm.ACCELERANCE)
        frf = noisy_record(rng, clean, FREQ, form=FrfForm.ACCELERANCE, level=0.01, axes=3)
        model = fit_modes(frf, max_order=20)
        assert len(model.modes) == 2
        for mode, shape, part in zip(
            model.modes, shapes[:, :, 0], participation[:, 0], strict=True
        ):
            reach = student.ppf(0.975, mode.shape_dof)
            truth = shape / shape[np.argmax(np.abs(mode.shape))]
            rest = np.abs(mode.shape) < 1.0 - 1e-9
            error = mode.shape - truth
            inside.append(np.abs(error.real[rest]) < reach * mode.shape_std.real[rest])
            inside.append(np.abs(error.imag) < reach * mode.shape_std.imag)
            size = np.max(np.abs(mode.participation))
            turned = to_real_axis(mode.participation) / size
            error = turned - part / part[np.argmax(np.abs(turned))]
            std = mode.participation_std / size
            other = np.abs(turned) < 1.0 - 1e-9
            sides.append(np.abs(error.real[other]) < reach * std.real[other])
            sides.append(np.abs(error.imag) < reach * std.imag)
    assert low <= np.mean(np.concatenate(inside)) <= high
    assert low <= np.mean(np.concatenate(sides)) <= high


@pytest.mark.long
def test_orders_beyond_a_hundred_give_the_same_modes():
    truth = eight_modes(np.random.default_rng(3), n_resp=8)
    models = [fit_modes(truth.frf, max_order=order) for order in (60, 130)]
    assert models[1].stabilisation.orders[-1] == 130
    # Refined to the same likelihood; steps stop at 1e-5 of a half bandwidth.
    np.testing.assert_allclose(models[0].f_hz, models[1].f_hz, rtol=1e-5)


def test_a_line_at_0_hz_and_a_rigid_body_part_give_no_mode_there():
    rng = np.random.default_rng(4)
    poles = poles_of([0.4, 12.0, 30.0], [0.2, 0.03, 0.02])
    residues = rng.standard_normal((3, 12, 1)) / (2j * poles.imag[:, None, None])
    freq = np.arange(3.0, 60.0, 0.25)
    clean = modal_frf(poles, residues, freq, FrfForm.ACCELERANCE)
    model = fit_modes(noisy_record(rng, clean, freq, form=FrfForm.ACCELERANCE, level=0.01))
    np.testing.assert_allclose(model.f_hz, [12.0, 30.0], rtol=2e-3)


def test_a_participation_that_is_held_has_no_scatter_and_the_others_have_their_own():
    """Of two modes over three references: four entries of poles, then the free participations."""
    fit = SimpleNamespace(participation=np.zeros((3, 2)), held=np.array([1, 0]))
    theta = np.arange(144.0).reshape(12, 12)
    # Reference by reference, mode by mode: (0, 0), (1, 1), (2, 0), (2, 1) are free.
    of_mode = {0: [4, 5, None, None, 8, 9], 1: [None, None, 6, 7, 10, 11]}
    for mode, at in of_mode.items():
        found = participation_covariance(fit, theta, mode)
        for i, j in np.ndindex(6, 6):
            both = at[i] is not None and at[j] is not None
            assert found[i, j] == (theta[at[i], at[j]] if both else 0.0)
