"""What tolerances of the arm do to fitted stiffness."""

from dataclasses import replace

import numpy as np
import pytest
from support.plain_arm import TESTS_DEG, mass_matrix
from support.small_fit import measured, state_of, true_structure, unmeasured

from armodal.analyzer.arm import Superset
from armodal.analyzer.identification.frf_fit import fit_frfs
from armodal.analyzer.identification.model_error import model_error_std, model_moves
from armodal.analyzer.identification.parameters import step_state
from armodal.protocols.arm.records import InertialStd, Tolerances

POINTS = ("1", "5", "9", "12")
FREQ_HZ = np.linspace(8, 40, 12)
NONE = Tolerances(
    mass=0.0,
    inertia=0.0,
    center_m=0.0,
    encoder_offset_rad=0.0,
    sensor_tilt_rad=0.0,
    sensor_gain=10.0,  # gains unknown: the inertia may not be read from the FRFs' size
    hammer_gain=10.0,
    hit_direction_rad=0.02,
)


def fitted(arm, structure, test):
    """A superset, noise-free data of one posture, and the fit to it."""
    superset = Superset(arm)
    state = state_of(structure, 1)
    blank = unmeasured(superset, test, POINTS, FREQ_HZ, mass_kg=0.0)
    data = (measured(superset, blank, state, 0),)
    n = 2 * len(structure.joints)
    near = step_state(state, np.r_[np.full(n, 0.01), np.zeros(5)])
    return superset, data, fit_frfs(superset, data, near)


def weightless(arm, **tolerances):
    return replace(arm, gravity_m_s2=np.zeros(3), tolerances=replace(NONE, **tolerances))


def without_link(arm, j):
    link = arm.joints[j].link
    joints = list(arm.joints)
    joints[j] = replace(joints[j], link=replace(link, mass_kg=0.0, inertia_kg_m2=np.zeros((3, 3))))
    return replace(arm, joints=tuple(joints))


@pytest.mark.parametrize("test", [1, 2])
def test_stiffness_takes_each_links_share_of_the_inertia(arm, test):
    """One joint: k and c are proportional to I, a sum over links with independent masses."""
    q = np.deg2rad(TESTS_DEG[test])
    superset, data, fit = fitted(weightless(arm, mass=0.05), true_structure(joints=(test,)), test)
    whole = mass_matrix(arm, q)[test, test]
    shares = [1 - mass_matrix(without_link(arm, j), q)[test, test] / whole for j in range(6)]
    expected = 0.05 * np.sqrt(np.sum(np.square(shares)))
    std = model_error_std(model_moves(superset, data, fit))
    # c leaves its slope by 25 times the relative move of I, here 5e-7; gains are all but free.
    np.testing.assert_allclose(std[:2], expected, rtol=5e-5)


def test_no_tolerance_is_no_model_error(arm):
    superset, data, fit = fitted(weightless(arm), true_structure(joints=(1,)), 1)
    std = model_error_std(model_moves(superset, data, fit))
    # Predictions with and without derivatives differ by rounding; the tolerances leave 1e-2.
    np.testing.assert_allclose(std, np.zeros(7), atol=1e-9)


def test_links_weighed_together_leave_one_anothers_mass_to_one_another(arm):
    """With the sum known, a spring sees only what the links' shares of the inertia differ by."""
    q = np.deg2rad(TESTS_DEG[1])
    whole = mass_matrix(arm, q)[1, 1]
    shares = np.array([1 - mass_matrix(without_link(arm, j), q)[1, 1] / whole for j in range(6)])
    mass = np.array([joint.link.mass_kg for joint in arm.joints])
    for known in (0.02, 0.5):
        weighed = weightless(arm, mass=0.1, moving_mass=known)
        superset, data, fit = fitted(weighed, true_structure(joints=(1,)), 1)
        # The shares are linear in the masses: the variance given their sum, in closed form.
        square = (0.1 * mass) ** 2
        slope = shares / mass
        of_sum = square.sum() + (known * mass.sum()) ** 2
        expected = np.sqrt(slope**2 @ square - (slope @ square) ** 2 / of_sum)
        std = model_error_std(model_moves(superset, data, fit))
        np.testing.assert_allclose(std[:2], expected, rtol=1e-4)


def test_a_links_own_tolerance_goes_before_the_arms(arm):
    own = InertialStd(mass=0.2, inertia=0.0, center_m=0.0)
    joints = tuple(replace(j, inertial_std=own) for j in arm.joints)
    structure = true_structure(joints=(1,))
    stds = []
    for one in (weightless(arm, mass=0.2), weightless(replace(arm, joints=joints), mass=0.9)):
        superset, data, fit = fitted(one, structure, 1)
        stds.append(model_error_std(model_moves(superset, data, fit)))
    np.testing.assert_allclose(*stds, rtol=1e-12)


def test_errors_of_several_kinds_add_as_variances(arm):
    structure = true_structure()
    kinds = {"mass": 0.05, "inertia": 0.06, "center_m": 0.003, "encoder_offset_rad": 0.003}
    squares = []
    for kind, size in kinds.items():
        superset, data, fit = fitted(weightless(arm, **{kind: size}), structure, 1)
        squares.append(model_error_std(model_moves(superset, data, fit)) ** 2)
    superset, data, fit = fitted(weightless(arm, **kinds), structure, 1)
    together = model_error_std(model_moves(superset, data, fit))
    np.testing.assert_allclose(together**2, np.sum(squares, axis=0), rtol=1e-6, atol=1e-20)


def test_a_refit_with_a_heavier_link_moves_by_what_is_stated(arm):
    """The one Gauss-Newton step against the fit itself, each link in turn 2 % heavier."""
    structure = true_structure()
    superset, data, fit = fitted(weightless(arm, mass=0.02), structure, 1)
    moves = []
    for j, joint in enumerate(superset.arm.joints):
        link = joint.link
        joints = list(superset.arm.joints)
        joints[j] = replace(
            joint,
            link=replace(
                link, mass_kg=link.mass_kg * 1.02, inertia_kg_m2=link.inertia_kg_m2 * 1.02
            ),
        )
        other = Superset(replace(superset.arm, joints=tuple(joints)))
        heavier = (replace(data[0], dynamics=other.posture(data[0].dynamics.joints_rad)),)
        again = fit_frfs(other, heavier, fit.state).state.structure
        moves.append(
            np.log(
                np.r_[again.all_stiffness(), again.all_damping()]
                / np.r_[structure.all_stiffness(), structure.all_damping()]
            )
        )
    stated = model_error_std(model_moves(superset, data, fit))[:6]
    # One step of a mildly nonlinear fit.
    np.testing.assert_allclose(np.sqrt(np.sum(np.square(moves), axis=0)), stated, rtol=0.1)
