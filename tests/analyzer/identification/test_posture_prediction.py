"""Modes predicted in postures nobody measured: against closed forms and the plant's truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.made_fits import made_fit
from support.plain_arm import TESTS_DEG, mass_matrix
from support.small_fit import measured, state_of, true_axis, true_structure, unmeasured
from support.viper_session import elastic_truth, viper_result, viper_session

from armodal.analyzer.arm import Superset, reduce_model
from armodal.analyzer.arm.reduced import model_modes
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.identification.frf_fit import fit_frfs
from armodal.analyzer.identification.model_error import model_moves
from armodal.analyzer.identification.parameters import step_state
from armodal.analyzer.identification.predicted_posture import predict_posture
from armodal.analyzer.identification.prediction import predict_modes, prediction_model_std
from armodal.protocols.arm.records import Tolerances

MASS_STD = 0.05
MASS_ONLY = Tolerances(
    mass=MASS_STD,
    inertia=0.0,
    center_m=0.0,
    encoder_offset_rad=0.0,
    sensor_tilt_rad=0.0,
    sensor_gain=10.0,  # gains unknown: the inertia may not be read from the FRFs' size
    hammer_gain=10.0,
    hit_direction_rad=0.02,
)


def shares(arm, q, joint):
    """Each link's part of the moment of inertia about a joint."""
    whole = mass_matrix(arm, q)[joint, joint]
    parts = []
    for j in range(len(arm.joints)):
        joints = list(arm.joints)
        link = joints[j].link
        joints[j] = replace(
            joints[j], link=replace(link, mass_kg=0.0, inertia_kg_m2=np.zeros((3, 3)))
        )
        parts.append(1 - mass_matrix(replace(arm, joints=tuple(joints)), q)[joint, joint] / whole)
    return np.array(parts)


def test_a_heavier_link_moves_a_prediction_by_the_difference_of_its_shares(arm):
    """Without gravity f2² = k / I2 and k = f1² I1: d ln f2 = (d ln I1 - d ln I2) / 2."""
    arm = replace(arm, gravity_m_s2=np.zeros(3), tolerances=MASS_ONLY)
    superset, structure = Superset(arm), true_structure(joints=(1,))
    state = state_of(structure, 1)
    blank = unmeasured(superset, 1, ("1", "5", "9"), np.linspace(8, 40, 12), mass_kg=0.0)
    data = (measured(superset, blank, state, 0),)
    fit = fit_frfs(superset, data, step_state(state, np.r_[0.01, 0.01, np.zeros(5)]))
    moves = model_moves(superset, data, fit)
    seen, asked = (np.deg2rad(TESTS_DEG[i]) for i in (1, 2))
    for q, expected in (
        (seen, 0.0),
        (asked, MASS_STD / 2 * np.linalg.norm(shares(arm, seen, 1) - shares(arm, asked, 1))),
    ):
        base = model_modes(reduce_model(superset, superset.posture(q), fit.state.structure))
        found = prediction_model_std(q, fit, moves, base=base)
        # One joint's c enters |pole| not at all; rounding over a move of 1e-5 leaves 1e-7, and
        # the one Gauss-Newton step of the fit errs by 5e-5 of the move of k.
        assert found.f_std_hz[0] / base.f_hz[0] == pytest.approx(expected, rel=5e-4, abs=5e-6)


def test_shapes_answer_to_stiffness_as_their_differences_do(superset):
    structure = true_structure([true_axis()])
    names = made_fit(superset, structure).parameters.names
    at, std = names.index("ln k joint_2"), 0.01
    covariance = np.zeros((len(names), len(names)))
    covariance[at, at] = std**2
    q = np.deg2rad(TESTS_DEG[2])
    none = np.zeros(len(superset.arm.points))
    dynamics = superset.posture(q)
    fit = made_fit(superset, structure, covariance)
    found = predict_modes(superset, dynamics, fit, added_mass_kg=none)
    step = np.zeros(len(names))
    step[at] = 1e-4
    stiffer = predict_modes(
        superset,
        dynamics,
        made_fit(superset, step_state(fit.state, step).structure),
        added_mass_kg=none,
    )
    slope = (stiffer.shape - found.shape).real / 1e-4
    # A Student t of ten degrees of freedom; one-sided differences leave 1e-4 of the slope.
    expected = np.abs(slope) * std * np.sqrt(10 / 8)
    np.testing.assert_allclose(found.shape_std, expected, rtol=2e-3, atol=1e-6)
    np.testing.assert_allclose(np.abs(found.shape).max(axis=0), 1.0)
    np.testing.assert_allclose(found.strain_share.sum(axis=0), 1.0)


@pytest.mark.long
@pytest.mark.parametrize("posture_deg", [(0, 30, 30, 0, 90, 0), (30, -50, 160, 0, 90, 0)])
def test_a_session_predicts_postures_it_never_saw(posture_deg, tmp_path_factory):
    folder = tmp_path_factory.getbasetemp()
    arm = viper_session(folder).header.arm
    result = viper_result(folder)
    found = predict_posture(arm, result, [float(angle) for angle in posture_deg])
    superset = Superset(arm)
    k, c = elastic_truth(arm)
    truth = replace(believed_structure(arm), stiffness_n_m_per_rad=k, damping_n_m_s_per_rad=c)
    modes = model_modes(reduce_model(superset, superset.posture(np.deg2rad(posture_deg)), truth))
    predicted = found.predicted
    f_error = np.abs(predicted.modes.f_hz - modes.f_hz)
    damping_error = np.abs(predicted.modes.damping_ratio - modes.damping_ratio)
    # The plant has the believed inertias, so scatter alone speaks: 4 standard deviations of a
    # Student t of few mountings, and half a per cent for the sensor's hidden tilts.
    assert (f_error < np.maximum(4 * predicted.f_std_hz, 0.005 * modes.f_hz)).all()
    assert (damping_error < np.maximum(4 * predicted.damping_std, 0.05 * modes.damping_ratio)).all()
