from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from scipy.integrate import solve_ivp

from armodal.hil_sim.newton_euler import (
    Body,
    Chain,
    gravity_stiffness,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
    place,
    point_jacobian,
    with_point_mass,
)
from armodal.hil_sim.plant import build_plant, load_plant
from armodal.protocols.arm.files import ARMS_DIRECTORY

# Two independent ways to the same sums of about a hundred products: rounding alone, some hundred
# machine epsilons of the largest entry.
ROUNDING = 1e-12

URDF = Path(ARMS_DIRECTORY) / "rv4frl.urdf"


@pytest.fixture(scope="module")
def chain():
    truth = load_plant("rv4frl").truth
    return build_plant(truth.model_copy(update={"hidden_axis": None})).chain


@pytest.fixture(scope="module")
def reference():
    model = pinocchio.buildModelFromUrdf(str(URDF))
    model.gravity.linear = np.array([0.0, 0.0, -9.80665])
    return model, model.createData()


def states(n=6, count=5):
    rng = np.random.default_rng(7)
    return rng.uniform(-2.0, 2.0, (count, 3, n))


def planar_arm():
    """Two bars in the x-z plane, hinged about y, lengths and all masses known."""
    rod = {
        "R_parent_body": np.eye(3),
        "hinge_m": np.zeros(3),
        "axis": np.array([0.0, 1.0, 0.0]),
    }
    upper = Body(
        name="a",
        origin_m=np.zeros(3),
        mass_kg=2.0,
        center_m=np.array([0.3, 0.0, 0.0]),
        inertia_kg_m2=np.diag([0.01, 0.05, 0.05]),
        **rod,
    )
    lower = Body(
        name="b",
        origin_m=np.array([0.7, 0.0, 0.0]),
        mass_kg=1.5,
        center_m=np.array([0.2, 0.0, 0.0]),
        inertia_kg_m2=np.diag([0.01, 0.03, 0.03]),
        **rod,
    )
    return Chain(bodies=(upper, lower), gravity_m_s2=np.array([0.0, 0.0, -9.80665]))


def test_mass_matrix_is_that_of_pinocchio(chain, reference):
    model, data = reference
    for q, _, _ in states():
        upper = np.triu(pinocchio.crba(model, data, q))
        wanted = upper + np.triu(upper, 1).T
        assert mass_matrix(chain, q) == pytest.approx(wanted, abs=ROUNDING * wanted.max())


def test_inverse_dynamics_is_that_of_pinocchio(chain, reference):
    model, data = reference
    for q, qd, qdd in states():
        wanted = pinocchio.rnea(model, data, q, qd, qdd)
        got = inverse_dynamics(chain, q, qd, qdd)
        assert got == pytest.approx(wanted, abs=ROUNDING * np.abs(wanted).max())


def test_gravity_stiffness_is_the_derivative_of_pinocchio(chain, reference):
    model, data = reference
    for q, _, _ in states():
        wanted = pinocchio.computeGeneralizedGravityDerivatives(model, data, q)
        # Truncation h^2/6 with h = 1e-4, and rounding 1e-16/h: below 1e-8 together.
        got = gravity_stiffness(chain, q)
        assert got == pytest.approx(wanted, abs=1e-8 * np.abs(wanted).max())


def test_a_rigid_hidden_axis_changes_nothing(chain):
    plant = load_plant("rv4frl")
    joints = list(plant.joints)
    for q, _, _ in states():
        M = mass_matrix(plant.chain, plant.hinge_angles(q))[np.ix_(joints, joints)]
        assert pytest.approx(mass_matrix(chain, q), abs=ROUNDING * M.max()) == M


def test_states_in_a_batch_give_what_they_give_alone(chain):
    many = states(count=4)
    q, qd, qdd = many[:, 0], many[:, 1], many[:, 2]
    alone = [inverse_dynamics(chain, *state) for state in many]
    assert inverse_dynamics(chain, q, qd, qdd) == pytest.approx(np.array(alone), rel=ROUNDING)


def test_planar_arm_follows_its_closed_form():
    # Craig, "Introduction to Robotics", section 6.7, with inertias about the centres.
    m1, m2, l1, c1, c2, I1, I2, g = 2.0, 1.5, 0.7, 0.3, 0.2, 0.05, 0.03, 9.80665
    for q, qd, qdd in states(n=2):
        cos, sin = np.cos(q[1]), np.sin(q[1])
        coupling = I2 + m2 * (c2**2 + l1 * c2 * cos)
        M = np.array(
            [
                [I1 + m1 * c1**2 + I2 + m2 * (l1**2 + c2**2 + 2.0 * l1 * c2 * cos), coupling],
                [coupling, I2 + m2 * c2**2],
            ]
        )
        h = m2 * l1 * c2 * sin
        centrifugal = np.array([-h * qd[1] * (2.0 * qd[0] + qd[1]), h * qd[0] ** 2])
        # Turning about +y moves +x downwards, so gravity helps a positive turn.
        tip = m2 * c2 * g * np.cos(q.sum())
        weight = -np.array([(m1 * c1 + m2 * l1) * g * np.cos(q[0]) + tip, tip])
        wanted = M @ qdd + centrifugal + weight
        arm = planar_arm()
        assert mass_matrix(arm, q) == pytest.approx(M, abs=ROUNDING)
        assert gravity_torque(arm, q) == pytest.approx(weight, abs=ROUNDING * 30.0)
        assert inverse_dynamics(arm, q, qd, qdd) == pytest.approx(wanted, abs=ROUNDING * 30.0)


def energy_j(chain, q, qd):
    at = place(chain, q)
    kinetic = 0.5 * qd @ mass_matrix(chain, q) @ qd
    centers = [at.origin_m[i] + at.R[i] @ b.center_m for i, b in enumerate(chain.bodies)]
    weights = [
        b.mass_kg * chain.gravity_m_s2 @ c for b, c in zip(chain.bodies, centers, strict=True)
    ]
    return kinetic - sum(weights)


def test_a_free_swing_keeps_its_energy(chain):
    # The last two links are so light that free they would spin at once: three joints suffice.
    arm = replace(chain, bodies=chain.bodies[:3])

    def slope(_, state):
        q, qd = state[:3], state[3:]
        bias = inverse_dynamics(arm, q, qd, np.zeros(3))
        return np.concatenate([qd, np.linalg.solve(mass_matrix(arm, q), -bias)])

    begin = np.array([0.2, 0.4, 0.8, 1.0, -0.5, 0.7])
    swing = solve_ivp(slope, (0.0, 0.3), begin, rtol=1e-10, atol=1e-12)
    energy = [energy_j(arm, s[:3], s[3:]) for s in swing.y.T]
    exchanged = np.ptp([0.5 * s[3:] @ mass_matrix(arm, s[:3]) @ s[3:] for s in swing.y.T])
    assert exchanged > 1.0
    # rtol 1e-10 a step over some ten steps, times a few for the energy's slope.
    assert np.ptp(energy) < 1e-8 * exchanged


def test_jacobian_is_the_slope_of_a_point_and_of_its_frame(chain):
    q, body, local = states()[0, 0], 4, np.array([0.03, -0.02, 0.05])

    def position(q):
        at = place(chain, q)
        return at.origin_m[body] + at.R[body] @ local

    h = 1e-5
    J = point_jacobian(place(chain, q), body, position(q))
    for i, step in enumerate(h * np.eye(6)):
        slope = (position(q + step) - position(q - step)) / (2.0 * h)
        turn = place(chain, q + step).R[body] @ place(chain, q - step).R[body].T / (2.0 * h)
        spin = 0.5 * np.array(
            [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
        # Central differences: h^2/6 of truncation and 1e-16/h of rounding, about 2e-11 each.
        assert J[:3, i] == pytest.approx(slope, abs=1e-9)
        assert J[3:, i] == pytest.approx(spin, abs=1e-9)


def test_a_point_mass_adds_its_own_mass_matrix(chain):
    q, body, local, mass_kg = states()[1, 0], 3, np.array([0.05, -0.02, 0.2]), 0.8
    at = place(chain, q)
    J = point_jacobian(at, body, at.origin_m[body] + at.R[body] @ local)[:3]
    loaded = mass_matrix(with_point_mass(chain, body, local, mass_kg), q)
    wanted = mass_matrix(chain, q) + mass_kg * J.T @ J
    assert loaded == pytest.approx(wanted, abs=ROUNDING * wanted.max())
