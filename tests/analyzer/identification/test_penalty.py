"""The penalty method of file 002, Eq. (13), by itself and on a session."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.added import any_of, axis, with_effects
from support.made_modes import dofs_of, made_modes, mode_of
from support.plain_arm import TESTS_DEG
from support.small_fit import true_structure
from support.viper_session import true_values, viper_result, viper_session

from armodal.analyzer.arm.reduced import model_modes, reduce_model
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.identification.doubted_axes import doubted_axes
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.penalty import fit_by_penalty
from armodal.analyzer.identification.penalty_of_session import chosen_joints, penalty_of_session
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import EstimateError

POSTURES = [np.deg2rad(q) for q in TESTS_DEG]
GUESS = np.array([0.75, 1.3, 0.8])


def lightly_damped():
    """Damping ratios below 1e-4: |pole| is then the undamped frequency to 1e-9."""
    truth = true_structure()
    return replace(truth, damping_n_m_s_per_rad=truth.damping_n_m_s_per_rad * 1e-3)


def guessed(truth, chosen):
    k = truth.stiffness_n_m_per_rad.copy()
    k[list(chosen)] *= GUESS[list(chosen)]
    return replace(truth, stiffness_n_m_per_rad=k)


def all_modes(superset, truth):
    return tuple(made_modes(superset, q, truth) for q in POSTURES)


@pytest.mark.parametrize("chosen", [(2,), (0, 2), (0, 1, 2)])
def test_any_chosen_joints_are_found_and_the_others_kept(superset, chosen):
    truth = lightly_damped()
    start = guessed(truth, chosen)
    found = fit_by_penalty(superset, start, all_modes(superset, truth), chosen)
    # |pole| differs from the undamped frequency by the square of the coupling through damping.
    np.testing.assert_allclose(
        found.structure.stiffness_n_m_per_rad, truth.stiffness_n_m_per_rad, rtol=1e-6
    )
    for i in set(range(3)) - set(chosen):
        assert found.structure.stiffness_n_m_per_rad[i] == start.stiffness_n_m_per_rad[i]
    assert found.penalty_hz2 < 1e-9
    assert found.left_out == 0
    # Light damping couples no modes: what each measured is what the dampers found make of it.
    for pair in found.pairs:
        assert pair.predicted_damping == pytest.approx(pair.measured_damping, rel=1e-3)


def test_the_penalty_is_least_there(superset):
    """Frequencies that no stiffness meets, too near for modes to change places."""
    truth = lightly_damped()
    rng = np.random.default_rng(2)
    off = []
    for posture in all_modes(superset, truth):
        modes = tuple(
            replace(mode, f_hz=mode.f_hz * (1 + 0.003 * rng.standard_normal()))
            for mode in posture.modes
        )
        off.append(MeasuredModes(superset, posture.dynamics, modes, dofs_of_all(superset, posture)))
    found = fit_by_penalty(superset, guessed(truth, (0, 1, 2)), tuple(off), (0, 1, 2))

    def penalty(k):
        total = 0.0
        for posture in off:
            structure = replace(truth, stiffness_n_m_per_rad=k)
            f = model_modes(reduce_model(superset, posture.dynamics, structure)).f_hz
            total += sum((mode.f_hz - f[i]) ** 2 for i, mode in enumerate(posture.modes))
        return total

    k = found.structure.stiffness_n_m_per_rad
    assert found.penalty_hz2 == pytest.approx(penalty(k), rel=1e-6)
    for i in range(3):
        for factor in (0.999, 1.001):
            moved = k.copy()
            moved[i] *= factor
            assert penalty(moved) > found.penalty_hz2
    assert (found.k_std > 0).all()


def dofs_of_all(superset, posture):
    return dofs_of(superset, posture.dynamics)


def test_modal_damping_gives_every_joints_damping(superset):
    """Eq. (6) with light damping: phiᵀ C phi / (2 omega) is the damping ratio to second order."""
    truth = lightly_damped()
    found = fit_by_penalty(superset, truth, all_modes(superset, truth), (2,))
    np.testing.assert_allclose(
        found.structure.damping_n_m_s_per_rad, truth.damping_n_m_s_per_rad, rtol=1e-5
    )


def test_modes_are_paired_by_shape_and_never_by_order(superset):
    """The guess has modes 1 and 2 of test 1 in the other order than the truth."""
    truth = lightly_damped()
    start = replace(truth, stiffness_n_m_per_rad=truth.stiffness_n_m_per_rad * [1.6, 0.6, 1.0])
    measured = made_modes(superset, POSTURES[0], truth)
    model = reduce_model(superset, measured.dynamics, start)
    first = np.abs(model_modes(model).shape[:, 0])
    true_first = np.abs(model_modes(reduce_model(superset, measured.dynamics, truth)).shape[:, 0])
    assert np.argmax(first) != np.argmax(true_first)
    found = fit_by_penalty(superset, start, all_modes(superset, truth), (0, 1, 2))
    np.testing.assert_allclose(
        found.structure.stiffness_n_m_per_rad, truth.stiffness_n_m_per_rad, rtol=1e-6
    )


def test_a_mode_of_no_model_shape_is_counted_and_has_no_say(superset):
    truth = lightly_damped()
    clean = made_modes(superset, POSTURES[0], truth)
    rows = clean.rows(reduce_model(superset, clean.dynamics, truth).point_jacobian)
    foreign = np.random.default_rng(1).normal(size=len(rows))
    foreign -= rows @ np.linalg.lstsq(rows, foreign, rcond=None)[0]
    dirty = MeasuredModes(
        superset,
        clean.dynamics,
        (*clean.modes, mode_of(-1.0 + 2j * np.pi * 17.0, foreign)),
        dofs_of_all(superset, clean),
    )
    found = fit_by_penalty(superset, guessed(truth, (0, 1)), (dirty,), (0, 1))
    assert found.left_out == 1
    np.testing.assert_allclose(
        found.structure.stiffness_n_m_per_rad, truth.stiffness_n_m_per_rad, rtol=1e-6
    )


def test_fewer_modes_than_joints_are_refused(superset):
    truth = lightly_damped()
    whole = made_modes(superset, POSTURES[0], truth)
    one = MeasuredModes(superset, whole.dynamics, whole.modes[:1], dofs_of_all(superset, whole))
    with pytest.raises(EstimateError, match="at least 3 measured modes"):
        fit_by_penalty(superset, truth, (one,), (0, 1, 2))


def test_a_joint_no_mode_strains_is_named(superset):
    truth = lightly_damped()
    whole = made_modes(superset, POSTURES[0], truth)
    model = reduce_model(superset, whole.dynamics, truth)
    shape = np.abs(model_modes(model).shape)
    own = int(np.argmax(shape[0] / shape.sum(axis=0)))
    only = MeasuredModes(
        superset, whole.dynamics, (whole.modes[own],), dofs_of_all(superset, whole)
    )
    with pytest.raises(EstimateError, match="no measured mode strains joint_3"):
        fit_by_penalty(superset, truth, (only,), (2,))


@pytest.mark.long
def test_on_a_session_it_starts_from_one_joint_values_and_nears_the_truth(tmp_path_factory):
    folder = tmp_path_factory.getbasetemp()
    session, result = viper_session(folder), viper_result(folder)
    arm = session.header.arm
    found = penalty_of_session(session, result, chosen_joints(arm, ["3", "joint_2"]))
    assert found.start_from == ("one-joint",) * 5
    assert found.postures == ("test 1", "test 2")
    k, _ = true_values(arm)
    for i in found.fit.chosen:
        # The roving sensor's mass is shared out among its mountings: some parts in a thousand.
        assert found.fit.structure.stiffness_n_m_per_rad[i] == pytest.approx(k[i], rel=0.01)


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        (["0"], "by name or number 1 to 6"),
        (["elbow"], "got 'elbow'"),
        (["6"], "joint_6 of arm 'viper_s650' has no stiffness"),
        (["2", "joint_2"], "each joint once"),
        (["²"], "by name or number"),
    ],
)
def test_wrong_joints_are_refused(wanted, message):
    arm = load_arm("viper_s650")
    with pytest.raises(EstimateError, match=message):
        chosen_joints(arm, wanted)


def test_effects_of_the_arm_file_stay_and_their_damping_is_no_joint_s(arm):
    effects = [any_of(arm, kind) for kind in ("bearing", "coupling", "payload", "rotor")]
    ready = held_arm(with_effects(arm, axis("elbow"), *effects))
    superset = Superset(ready.arm)
    held = replace(ready.held, damping=1e-3 * ready.held.damping)
    axes = tuple(
        replace(own, damping_n_m_s_per_rad=1e-3 * own.damping_n_m_s_per_rad) for own in ready.axes
    )
    truth = replace(lightly_damped(), axes=axes, held=held)
    found = fit_by_penalty(
        superset, guessed(truth, (0, 1, 2)), all_modes(superset, truth), (0, 1, 2)
    )
    assert found.left_out == 0
    np.testing.assert_allclose(
        found.structure.stiffness_n_m_per_rad, truth.stiffness_n_m_per_rad, rtol=1e-6
    )
    np.testing.assert_allclose(
        found.structure.damping_n_m_s_per_rad, truth.damping_n_m_s_per_rad, rtol=1e-3
    )
    for pair in found.pairs:
        assert pair.predicted_damping == pytest.approx(pair.measured_damping, rel=1e-3)


@pytest.mark.parametrize("there", [True, False])
def test_a_false_axis_of_the_arm_file_is_doubted_and_a_true_one_is_not(arm, there):
    ready = held_arm(with_effects(arm, axis("elbow")))
    superset = Superset(ready.arm)
    axes = tuple(
        replace(own, damping_n_m_s_per_rad=1e-3 * own.damping_n_m_s_per_rad) for own in ready.axes
    )
    truth = replace(lightly_damped(), axes=axes if there else (), held=ready.held)
    modes = all_modes(superset, truth)
    start = replace(guessed(truth, (0, 1, 2)), axes=axes)
    found = fit_by_penalty(superset, start, modes, (0, 1, 2))
    masses = (np.zeros(len(superset.arm.points)),) * len(modes)
    doubted = doubted_axes(superset, start, modes, found, added_mass_kg=masses)
    assert [own.link for own in doubted] == ([] if there else ["elbow"])
    if not there:
        (own,) = doubted
        # Without the axis the model is the truth.
        assert own.rms_without_hz < 1e-4 < own.rms_with_hz
        k = found.structure.stiffness_n_m_per_rad / truth.stiffness_n_m_per_rad
        assert k.max() > 1.05
