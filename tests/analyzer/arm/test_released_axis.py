"""An axis released inside a link against kinematics, energy and Newton-Euler written elsewhere."""

import numpy as np
import pytest
from support.plain_arm import (
    TESTS_DEG,
    mass_matrix,
    point_pose,
    potential_energy_j,
    second_difference,
)
from support.quick import every_nth

from armodal.analyzer.arm import Axis, Structure, reduce_model
from armodal.hil_sim.newton_euler import gravity_stiffness as plant_gravity_stiffness
from armodal.hil_sim.newton_euler import mass_matrix as plant_mass_matrix
from armodal.hil_sim.plant import load_plant

POSTURES = [np.deg2rad(q) for q in (*TESTS_DEG, (20, -10, 60, 40, 60, -30))]
STEP = 1e-6  # rad; central differences err by h² = 1e-12 and by rounding, 1e-16 / h = 1e-10


def axis_through(link, direction, point):
    direction = np.asarray(direction) / np.linalg.norm(direction)
    point = np.asarray(point)
    return Axis(
        link=link,
        direction=direction,
        point_m=point - direction * (direction @ point),
        stiffness_n_m_per_rad=0.0,
        damping_n_m_s_per_rad=0.0,
    )


def some_axis(link=0):
    return axis_through(link, [1.0, 0.3, 0.29], [0.03, 0.0182, 0.1955])


def line(axis):
    return (axis.link, axis.direction, axis.point_m)


def released(superset, posture, axis):
    """All joints and an axis as a reduced model without springs."""
    structure = Structure(
        joints=tuple(range(6)),
        stiffness_n_m_per_rad=np.zeros(6),
        damping_n_m_s_per_rad=np.zeros(6),
        axes=(axis,),
    )
    return reduce_model(superset, superset.posture(posture), structure)


@pytest.mark.parametrize("q", POSTURES)
@pytest.mark.parametrize("link", [0, 1, 3])
def test_mass_matrix_is_that_of_file_002_with_one_more_hinge(arm, superset, q, link):
    axis = some_axis(link)
    M = released(superset, q, axis).mass
    np.testing.assert_allclose(M, mass_matrix(arm, q, [line(axis)]), atol=1e-12 * M.max())


@pytest.mark.parametrize("q", every_nth(POSTURES, 2))
@pytest.mark.parametrize("link", [pytest.param(0, marks=pytest.mark.long), 1])
def test_gravity_stiffness_is_the_curvature_of_the_potential_energy(arm, superset, q, link):
    axis = some_axis(link)

    def energy(x):
        return potential_energy_j(arm, q + x[:6], [line(axis)], x[6:])

    # Second differences: h² / 3 of some 200 J, and rounding 200 J x 1e-16 / h² = 2e-8.
    curvature = second_difference(energy, 7, 1e-3)
    np.testing.assert_allclose(released(superset, q, axis).stiffness, curvature, atol=2e-4)


@pytest.mark.parametrize("q", POSTURES)
def test_jacobians_are_the_slopes_of_positions_and_of_sensor_axes(arm, superset, q):
    axis = some_axis()
    J = released(superset, q, axis).point_jacobian
    for number, point in enumerate(arm.points):
        for column in range(7):
            step = STEP * np.eye(7)[column]
            ahead, R_ahead = point_pose(arm, point.id, q + step[:6], [line(axis)], step[6:])
            behind, R_behind = point_pose(arm, point.id, q - step[:6], [line(axis)], -step[6:])
            slope = (ahead - behind) / (2 * STEP)
            np.testing.assert_allclose(J[number, :3, column], slope, atol=1e-9)
            spin = (R_ahead - R_behind) / (2 * STEP) @ ((R_ahead + R_behind) / 2).T
            found = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
            np.testing.assert_allclose(J[number, 3:, column], found, atol=1e-9)


def test_an_axis_carries_its_link_and_all_beyond_and_nothing_before(arm, superset):
    J = released(superset, POSTURES[0], some_axis(link=1)).point_jacobian[:, :, 6]
    names = [joint.link.name for joint in arm.joints]
    for number, point in enumerate(arm.points):
        before = point.link == "base" or names.index(point.link) < 1
        assert (np.abs(J[number]).max() == 0.0) == before


def test_points_of_the_axis_stand_still():
    axis = some_axis()
    twist = axis.twist()
    for along in (-0.3, 0.0, 0.7):
        point = axis.point_m + along * axis.direction
        np.testing.assert_allclose(twist[:3] + np.cross(twist[3:], point), 0.0, atol=1e-15)


@pytest.mark.parametrize("q", POSTURES)
def test_the_simulated_plant_has_the_same_mass_and_gravity(superset, q):
    plant = load_plant("rv4frl")
    hidden = plant.truth.hidden_axis
    model = released(superset, q, axis_through(0, hidden.direction, hidden.point_m))
    order = [*plant.joints, plant.hidden]
    hinges = plant.hinge_angles(q)
    M = plant_mass_matrix(plant.chain, hinges)[np.ix_(order, order)]
    np.testing.assert_allclose(model.mass, M, atol=1e-12)
    K = plant_gravity_stiffness(plant.chain, hinges)[np.ix_(order, order)]
    # Central differences there: 1e-8 of the largest entry, some 200 N m/rad.
    np.testing.assert_allclose(model.stiffness, K, atol=4e-6)
