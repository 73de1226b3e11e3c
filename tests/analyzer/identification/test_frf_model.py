"""Model FRFs against modal sums, statics and differences."""

from dataclasses import replace

import numpy as np
import pytest
from support.small_fit import state_of, true_axis, true_structure, unmeasured

from armodal.analyzer.arm import reduce_model
from armodal.analyzer.arm.reduced import model_modes
from armodal.analyzer.identification.frf_model import (
    posture_data,
    predict,
    predict_with_derivatives,
)
from armodal.analyzer.identification.parameters import FitState, ParameterNames, step_state
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

FREQ_HZ = np.linspace(4, 110, 25)
POINTS = ("1", "5", "7", "12", "15", "18")


def crooked(n_postures):
    """A state with every nuisance away from its mean."""
    state = state_of(true_structure([true_axis()]), n_postures)
    return FitState(
        structure=state.structure,
        log_gain=np.array([0.02, -0.01, 0.03]),
        hit_tilt_rad=np.full((n_postures, 2), [0.02, -0.01]),
    )


@pytest.mark.parametrize("posture", [0, 1])
def test_derivatives_are_the_central_differences_of_the_prediction(superset, posture):
    data = unmeasured(superset, posture, POINTS, FREQ_HZ)
    state = crooked(2)
    y, dy = predict_with_derivatives(superset, data, state, posture)
    np.testing.assert_array_equal(y, predict(superset, data, state, posture))
    names = ParameterNames.of(superset.arm, state.structure, ("test 1", "test 2")).names
    assert len(dy) == len(names)
    h = 1e-6
    for row, (name, exact) in enumerate(zip(names, dy, strict=True)):
        step = h * np.eye(len(names))[row]
        ahead = predict(superset, data, step_state(state, step), posture)
        behind = predict(superset, data, step_state(state, -step), posture)
        # h² times third derivatives, some (1 / 2 zeta)³ = 1e4 times the first at a peak, and
        # rounding of y through Z of condition 100: 1e-14 / h.
        size = max(np.abs(exact).max(), np.abs(y).max())
        np.testing.assert_allclose(
            (ahead - behind) / (2 * h), exact, atol=2e-7 * size, err_msg=name
        )


def test_the_tilt_of_one_postures_hit_does_nothing_in_another(superset):
    data = unmeasured(superset, 0, POINTS, FREQ_HZ)
    _, dy = predict_with_derivatives(superset, data, crooked(2), 0)
    assert np.abs(dy[-4:-2]).max() > 0.0
    np.testing.assert_array_equal(dy[-2:], np.zeros_like(dy[-2:]))


def test_hits_of_several_directions_have_no_common_tilt(superset):
    data = unmeasured(superset, 0, POINTS, FREQ_HZ, n_refs=2)
    state = crooked(1)
    y, dy = predict_with_derivatives(superset, data, state, 0)
    np.testing.assert_array_equal(dy[-2:], np.zeros_like(dy[-2:]))
    straight = replace(state, hit_tilt_rad=np.zeros((1, 2)))
    np.testing.assert_array_equal(predict(superset, data, straight, 0), y)


def test_without_gravity_frfs_are_the_sum_over_complex_modes(arm, superset):
    weightless = type(superset)(replace(arm, gravity_m_s2=np.zeros(3)))
    data = unmeasured(weightless, 0, POINTS, FREQ_HZ, mass_kg=0.0)
    state = state_of(true_structure([true_axis()]), 1)
    model = reduce_model(weightless, data.dynamics, state.structure)
    modes = model_modes(model)
    b = model.point_jacobian[data.hit_point[0], :3].T @ data.hit_direction[0]
    R = data.dynamics.point_rotation[data.sensor_point]
    rows = np.einsum("mji,mjn->min", R, model.point_jacobian[data.sensor_point][:, :3])
    s = data.s_rad_s
    y = np.zeros((len(POINTS), 3, len(s)), dtype=complex)
    for pole, shape in zip(modes.pole_rad_s, modes.shape.T, strict=True):
        # Residue of Z⁻¹: φ φᵀ / (φᵀ (2 p M + C) φ) for symmetric M, C, K.
        a = shape @ (2 * pole * model.mass + model.damping) @ shape
        residue = np.outer((rows @ shape).ravel(), [shape @ b / a]).reshape(*rows.shape[:2], 1)
        y += s**2 * (residue / (s - pole) + residue.conj() / (s - pole.conjugate()))
    found = predict(weightless, data, state, 0)[:, 0]
    np.testing.assert_allclose(found, y, atol=1e-9 * np.abs(y).max())


def test_at_rest_the_accelerometer_feels_gravity_in_its_turned_axes(superset):
    """A steady unit force: no acceleration, only R(θ) against g."""
    data = replace(unmeasured(superset, 1, POINTS, [1.0]), s_rad_s=np.zeros(1, dtype=complex))
    structure = true_structure([true_axis()])
    found = predict(superset, data, state_of(structure, 1), 0)[:, 0, :, 0]
    model = reduce_model(superset, data.dynamics, structure)
    load = model.point_jacobian[data.hit_point[0], :3].T @ data.hit_direction[0]
    turns = np.linalg.solve(model.stiffness, load)
    for mounting, point in enumerate(data.sensor_point):
        theta = model.point_jacobian[point, 3:] @ turns
        R = data.dynamics.point_rotation[point]
        # The sensor reads Rᵀ (a - g); its axes turn to R + θ x R.
        turned = R + np.cross(theta, R.T).T
        change = (turned - R).T @ -data.dynamics.gravity_m_s2
        np.testing.assert_allclose(found[mounting], change, atol=1e-15)


def test_the_sensor_loads_its_own_mounting_only(superset):
    state = state_of(true_structure([true_axis()]), 1)
    loaded = unmeasured(superset, 0, POINTS, FREQ_HZ, mass_kg=0.5)
    y = predict(superset, loaded, state, 0)
    for i, point in enumerate(POINTS):
        alone = unmeasured(superset, 0, (point,), FREQ_HZ, mass_kg=0.5)
        np.testing.assert_allclose(predict(superset, alone, state, 0)[0], y[i], rtol=1e-12)
    # The driving point's first mode falls when half a kilogram rides on it.
    light = unmeasured(superset, 0, ("1",), np.linspace(12, 17, 300), mass_kg=0.0)
    heavy = replace(light, sensor_mass_kg=0.5)
    peaks = [
        np.abs(predict(superset, d, state, 0)[0, 0]).sum(axis=0).argmax() for d in (heavy, light)
    ]
    assert peaks[0] < peaks[1]


def test_a_sensor_on_the_base_feels_nothing(superset):
    data = unmeasured(superset, 0, ("17", "18"), FREQ_HZ)
    assert not predict(superset, data, crooked(1), 0).any()


def response(superset, **changes):
    q = np.zeros(6)
    R = superset.posture(q).point_rotation[superset.point_index["5"]]
    shape = (3, 1, 4)
    frf = FrequencyResponse(
        posture="test",
        form=FrfForm.ACCELERANCE,
        freq_hz=np.arange(1.0, 5.0),
        decay_rad_s=1.5,
        values=np.arange(12.0).reshape(shape) + 0j,
        coherence=np.ones(shape),
        variance=np.ones(shape),
        n_hits=np.full((3, 1), 3),
        # The order of responses is the file's own: here z, x, y.
        responses=tuple(Dof(point="5", label="xyz"[i], direction=R[:, i]) for i in (2, 0, 1)),
        references=(Dof(point="1", label="hit", direction=np.array([0.0, 1.0, 0.0])),),
        joints_rad=q,
    )
    return replace(frf, **changes)


def test_rows_are_arranged_by_mounting_and_sensor_axis(superset):
    data = posture_data(superset, response(superset), sensor_mass_kg=0.01, stride=2)
    assert data.values.shape == (1, 1, 3, 2)
    np.testing.assert_array_equal(data.values[0, 0], [[4, 6], [8, 10], [0, 2]])
    np.testing.assert_allclose(data.s_rad_s, 1.5 + 2j * np.pi * np.array([1.0, 3.0]))
    assert data.one_direction


def test_frfs_without_joint_angles_are_refused(superset):
    with pytest.raises(EstimateError, match="no measured joint angles"):
        posture_data(superset, response(superset, joints_rad=None), sensor_mass_kg=0.01)


@pytest.mark.parametrize(("form", "power"), [(FrfForm.MOBILITY, 1), (FrfForm.RECEPTANCE, 2)])
def test_other_forms_are_brought_to_accelerance_on_their_own_line(superset, form, power):
    frf = response(superset)
    s = frf.decay_rad_s + 2j * np.pi * frf.freq_hz
    other = replace(
        frf,
        form=form,
        values=frf.values / s**power,
        variance=frf.variance / np.abs(s) ** (2 * power),
    )
    one, two = (posture_data(superset, x, sensor_mass_kg=0.01) for x in (frf, other))
    # machine epsilon of a product and a quotient
    np.testing.assert_allclose(two.values, one.values, rtol=1e-14)
    np.testing.assert_allclose(two.variance, one.variance, rtol=1e-14)


def test_responses_along_the_axes_of_the_base_are_turned_into_the_sensor_s(superset):
    frf = response(superset)
    D = np.array([dof.direction for dof in frf.responses])  # rows: sensor axes z, x, y in base
    in_base = replace(
        frf,
        values=np.einsum("kb,krl->brl", D, frf.values),
        responses=tuple(Dof(point="5", label="xyz"[i], direction=np.eye(3)[i]) for i in range(3)),
    )
    one, two = (posture_data(superset, x, sensor_mass_kg=0.01) for x in (frf, in_base))
    np.testing.assert_allclose(two.values, one.values, atol=1e-14 * np.abs(one.values).max())


def test_responses_that_are_not_perpendicular_are_refused(superset):
    frf = response(superset)
    skewed = replace(frf.responses[0], direction=frf.responses[1].direction)
    with pytest.raises(EstimateError, match="perpendicular"):
        posture_data(
            superset,
            replace(frf, responses=(skewed, *frf.responses[1:])),
            sensor_mass_kg=0.01,
        )


def test_a_missing_sensor_axis_is_named(superset):
    frf = response(superset)
    with pytest.raises(EstimateError, match=r"lacks the response .*'5', 'y'"):
        posture_data(superset, replace(frf, responses=frf.responses[:2]), sensor_mass_kg=0.01)
