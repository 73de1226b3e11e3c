import dataclasses

import numpy as np
import pytest
from support import hammer
from support.simulated_frfs import eight_modes, modal_frf, noisy_record, poles_of, record

from armodal.analyzer.modal import (
    convert_form,
    fit_modes,
    frac,
    mac,
    mass_scaling,
    missing_mode_hints,
    posture_frf,
    real_modes,
    synthesise,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof, FrfForm
from armodal.protocols.plan_records import Mode as PlanMode

FREQ = np.arange(5.0, 120.0, 0.25)
POLES = poles_of([12.0, 31.0, 70.0], [0.03, 0.02, 0.015])
AXES = np.eye(3)


def unit_mass_shapes(rng, n_points):
    """Shapes of unit modal mass at `n_points` points, three axes each: (3, n_points * 3)."""
    shapes = rng.standard_normal((3, 3 * n_points))
    return shapes + np.sign(shapes) * 0.3


def residues_of(shapes):
    """Receptance residues of unit-mass shapes hit along z at point 1."""
    return shapes[:, :, None] * shapes[:, 2, None, None] / (2j * POLES.imag[:, None, None])


def driving_record(rng, *, form, level=1e-3, decay=0.0, n_points=4):
    """FRFs of unit-mass modes hit along z at point 1, where a sensor sits too and all move well."""
    shapes = unit_mass_shapes(rng, n_points)
    shapes[:, 2] = np.sign(shapes[:, 2])
    clean = modal_frf(POLES, residues_of(shapes), FREQ, form, decay)
    frf = noisy_record(rng, clean, FREQ, form=form, level=level, axes=3)
    responses = tuple(
        dataclasses.replace(dof, direction=AXES["xyz".index(dof.label)]) for dof in frf.responses
    )
    reference = Dof(point="1", label="hit", direction=AXES[2])
    frf = dataclasses.replace(frf, responses=responses, references=(reference,), decay_rad_s=decay)
    return frf, shapes


@pytest.mark.parametrize("decay", [0.0, 3.0])
@pytest.mark.parametrize("target", list(FrfForm))
@pytest.mark.parametrize("source", list(FrfForm))
def test_forms_convert_exactly_also_under_a_window(source, target, decay):
    rng = np.random.default_rng(0)
    residues = rng.standard_normal((3, 2, 1)) / (2j * POLES.imag[:, None, None])
    frf = record(
        modal_frf(POLES, residues, FREQ, source, decay),
        FREQ,
        variance=np.ones((2, 1, FREQ.size)),
        form=source,
        decay=decay,
    )
    found = convert_form(frf, target)
    assert found.form is target
    np.testing.assert_allclose(
        found.values, modal_frf(POLES, residues, FREQ, target, decay), rtol=1e-12
    )
    back = convert_form(found, source)
    np.testing.assert_allclose(back.variance, frf.variance, rtol=1e-12)


def test_an_unknown_form_is_refused_with_the_known_ones():
    frf, _ = driving_record(np.random.default_rng(1), form=FrfForm.RECEPTANCE)
    with pytest.raises(EstimateError, match="receptance, mobility, accelerance"):
        convert_form(frf, "compliance")
    with pytest.raises(EstimateError, match="unknown"):
        fit_modes(dataclasses.replace(frf, form="compliance"))


@pytest.mark.parametrize("form", list(FrfForm))
def test_unit_mass_shapes_come_back_from_the_driving_point(form):
    frf, shapes = driving_record(np.random.default_rng(2), form=form)
    model = fit_modes(frf)
    found = mass_scaling(model)
    for scaling, truth in zip(found, shapes, strict=True):
        sign = np.sign(scaling.shape.real @ truth)
        # 0.1 % noise of the RMS on some ten lines of the peak.
        np.testing.assert_allclose(sign * scaling.shape, truth, atol=0.005 * np.abs(truth).max())
        mass = 1.0 / np.max(np.abs(truth)) ** 2
        assert scaling.modal_mass_kg == pytest.approx(mass, abs=5.0 * scaling.modal_mass_std_kg)
        assert scaling.modal_mass_std_kg < 0.01 * mass
        assert scaling.consistent
        assert abs(scaling.phase_deg) < 1.0
    # And round: the mass-scaled shapes alone give the amplitude at every resonance.
    at_hz = model.f_hz
    poles = [mode.pole_rad_s for mode in model.modes]
    residues = [
        np.outer(scaling.shape, [scaling.driving_value]) / (2j * pole.imag)
        for scaling, pole in zip(found, poles, strict=True)
    ]
    again = modal_frf(poles, residues, at_hz, form)
    truth = modal_frf(POLES, residues_of(shapes), at_hz, form)
    error = np.linalg.norm(again - truth, axis=(0, 1))
    assert np.all(error < 0.01 * np.linalg.norm(truth, axis=(0, 1)))


def test_a_driving_point_of_reversed_sign_is_said():
    frf, _ = driving_record(np.random.default_rng(3), form=FrfForm.ACCELERANCE)
    model = fit_modes(dataclasses.replace(frf, values=-frf.values))
    assert not any(scaling.consistent for scaling in mass_scaling(model))


def test_mass_needs_a_driving_point():
    frf, _ = driving_record(np.random.default_rng(4), form=FrfForm.RECEPTANCE)
    elsewhere = dataclasses.replace(frf.references[0], point="9")
    with pytest.raises(EstimateError, match="driving point"):
        mass_scaling(fit_modes(dataclasses.replace(frf, references=(elsewhere,))))


def test_real_modes_part_two_shapes_mixed_by_damping():
    rng = np.random.default_rng(5)
    truth = rng.standard_normal((10, 2))
    mixed = truth + 0.2j * truth[:, ::-1]
    found = real_modes(mixed)
    span = np.linalg.lstsq(truth, found, rcond=None)[1]
    assert np.all(span < 1e-20)  # of the same space, to rounding
    for column, shape in zip(found.T, truth.T, strict=True):
        # The mixing of 0.2 enters squared.
        assert mac(column, shape) > 1.0 - 4 * 0.2**4
    np.testing.assert_allclose(np.max(np.abs(found), axis=0), 1.0)


@pytest.mark.parametrize("shapes", [np.ones((1, 2)), np.ones((5, 2))])
def test_real_modes_of_dependent_shapes_are_refused(shapes):
    with pytest.raises(EstimateError, match="real modes"):
        real_modes(shapes)


def test_frac_is_blind_to_a_factor_and_sees_a_shift():
    rng = np.random.default_rng(6)
    H = modal_frf(POLES, rng.standard_normal((3, 2, 1)), FREQ, FrfForm.RECEPTANCE)
    np.testing.assert_allclose(frac(H, 3j * H), 1.0)
    assert np.all(frac(H, np.roll(H, 20, axis=-1)) < 0.9)


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(i, marks=pytest.mark.long) for i in range(1, 4))]
)
def test_the_misfit_says_where_a_mode_is_missing(seed):
    made = eight_modes(np.random.default_rng(seed))
    model = fit_modes(made.frf)
    assert missing_mode_hints(made.frf, model) == ()
    for left_out in (3, 6, 7):
        less = dataclasses.replace(
            model, modes=tuple(m for i, m in enumerate(model.modes) if i != left_out)
        )
        hint = missing_mode_hints(made.frf, less)[0]
        # Within its half bandwidth, 2 to 4.5 %.
        assert hint.f_hz == pytest.approx(model.modes[left_out].f_hz, rel=0.045)
        assert hint.beside_hz is None


@pytest.mark.parametrize(("lines_off", "is_beside"), [(1.5, True), (30.0, False)])
def test_a_misfit_within_two_lines_of_a_sharp_mode_is_that_mode_s(lines_off, is_beside):
    """A resonance narrower than the lines' spacing leaves its misfit a line beside it."""
    made = eight_modes(np.random.default_rng(0))
    model = fit_modes(made.frf)
    freq = made.frf.freq_hz
    rms = np.sqrt(np.mean(np.abs(made.frf.values) ** 2, axis=-1, keepdims=True))
    peak = rms / (1.0 + 1j * (freq - 160.0) / 4.0)
    sharp_hz = 160.0 - lines_off * (freq[1] - freq[0])
    sharp = dataclasses.replace(
        model.modes[0],
        f_hz=sharp_hz,
        damping_ratio=1e-6,
        pole_rad_s=2.0 * np.pi * sharp_hz * (-1e-6 + 1j),
        participation=np.zeros_like(model.modes[0].participation),
    )
    found = missing_mode_hints(
        dataclasses.replace(made.frf, values=made.frf.values + peak),
        dataclasses.replace(model, modes=(*model.modes, sharp)),
    )
    assert [hint.beside_hz for hint in found] == [sharp_hz if is_beside else None]


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(i, marks=pytest.mark.long) for i in range(1, 6))]
)
def test_a_misfit_that_rises_to_the_band_s_edge_is_no_missing_mode(seed):
    made = eight_modes(np.random.default_rng(seed))
    model = fit_modes(made.frf)
    rms = np.sqrt(np.mean(np.abs(made.frf.values) ** 2, axis=-1, keepdims=True))
    slope = rms * (made.frf.freq_hz[0] / made.frf.freq_hz)
    inside = rms / (1.0 + 1j * (made.frf.freq_hz - 160.0) / 4.0)
    for added, places in ((slope, []), (slope + inside, [160.0])):
        frf = dataclasses.replace(made.frf, values=made.frf.values + added)
        found = [hint.f_hz for hint in missing_mode_hints(frf, model)]
        assert found == pytest.approx(places, abs=2.0)  # half the added peak's width


@pytest.mark.parametrize("digits", [6, 16])
def test_what_rounding_leaves_of_an_exact_fit_is_no_misfit(digits):
    rng = np.random.default_rng(0)
    residues = rng.standard_normal((3, 5, 1)) / (2j * POLES.imag[:, None, None])
    exact = modal_frf(POLES, residues, FREQ, FrfForm.RECEPTANCE)
    printed = [complex(f"{value:.{digits}g}") for value in exact.ravel()]
    frf = record(np.reshape(printed, exact.shape), FREQ, form=FrfForm.RECEPTANCE)
    model = fit_modes(frf)
    assert len(model.modes) == 3
    assert missing_mode_hints(frf, model) == ()


def test_amplitude_at_every_resonance_survives_the_round_trip_from_hits():
    rng = np.random.default_rng(8)
    shapes = unit_mass_shapes(rng, 7)
    residues = shapes * shapes[:, 20, None] / (2j * POLES.imag[:, None])  # hit along -z at point 7
    session = hammer.session(
        POLES, -residues.reshape(3, 7, 3), rng=rng, noise=1e-3, rate=16384, samples=32768
    )
    model = fit_modes(posture_frf(session, "p", lambda _: np.eye(3), band_hz=(3.0, 150.0)))
    assert len(model.modes) == 3
    freq = np.array([12.0, 31.0, 70.0])
    truth = -modal_frf(POLES, residues[:, :, None], freq, FrfForm.ACCELERANCE)
    error = np.linalg.norm(synthesise(model, freq) - truth, axis=(0, 1))
    # The figure of the issue; the record's end leaves 0.1 % and the half-sine's aliases 0.1 %.
    assert np.all(error < 0.01 * np.linalg.norm(truth, axis=(0, 1)))
    for scaling, true in zip(mass_scaling(model), shapes, strict=True):
        assert scaling.modal_mass_kg == pytest.approx(1.0 / np.max(np.abs(true)) ** 2, rel=0.02)


@pytest.mark.long
def test_a_roving_hammer_gives_the_same_masses():
    rng = np.random.default_rng(9)
    shapes = unit_mass_shapes(rng, 1)
    along = rng.standard_normal((3, 6))
    along[:, 0] = -shapes[:, 2]  # point 1 is where the sensor sits, hit along -z
    residues = along[:, :, None] * shapes[:, None, :] / (2j * POLES.imag[:, None, None])
    session = hammer.session(POLES, residues, rng=rng, mode=PlanMode.ROVING_HAMMER)
    hits = tuple(dataclasses.replace(hit, sensor_point="1") for hit in session.hits)
    frf = posture_frf(
        dataclasses.replace(session, hits=hits), "p", lambda _: np.eye(3), band_hz=(3.0, 150.0)
    )
    for scaling, true in zip(mass_scaling(fit_modes(frf)), along, strict=True):
        sign = np.sign(scaling.shape.real @ true)
        # A 1.24 s record at 1652 Hz: its end and aliases leave some per cent.
        np.testing.assert_allclose(sign * scaling.shape, true, atol=0.05 * np.abs(true).max())
