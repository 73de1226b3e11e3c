"""A servo's loop that acts late, beside equations solved point by point, and its slopes."""

import numpy as np
import pytest
from support.bench_effects import JOINTS, instance_of
from support.without_errors import without_errors

from armodal.analyzer.arm.reduced import reduce_model
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.gap.model.hypothesis import Hypothesis

SOFT, ROTOR, LOSS_S, LATE_S = 3e-6, 4.0, 4e-3, 2.5e-3


@pytest.fixture
def servo(ordinary):
    joint = ordinary.arm.joints[1].name
    return joint, Hypothesis(ordinary=ordinary, instances=(instance_of(ordinary, "servo", joint),))


@pytest.fixture
def values(servo):
    joint, hypothesis = servo
    space = hypothesis.space()
    return without_errors(space.values(space.start())) | {
        f"servo compliance {joint}": SOFT,
        f"servo rotor {joint}": ROTOR,
        f"servo loss {joint}": LOSS_S,
        f"servo delay {joint}": LATE_S,
    }


def test_its_torque_is_that_of_its_error_a_delay_ago(superset, lines, posed, servo, values):
    """K e^(-s T) + D s e^(-s T) behind the transmission, with the rotor a coordinate more."""
    _, hypothesis = servo
    got = posed.values(hypothesis, lines, values)
    dynamics = superset.posture(JOINTS)
    structure = believed_structure(superset.arm)
    m = 7
    added = np.zeros(len(superset.arm.points))
    added[m] = lines.sensor_mass_kg
    model = reduce_model(superset, dynamics, structure, added_mass_kg=added)
    n = len(model.mass)
    J, R = model.point_jacobian[m], dynamics.point_rotation[m]
    b = np.append(model.point_jacobian[0][:3].T @ lines.hit_direction[0], 0.0)
    at = 1  # the joint's coordinate: as in the arm, before all others
    k, c = model.stiffness[at, at], model.damping[at, at]
    gravity_part = k - superset.arm.joints[1].stiffness.value
    k -= gravity_part
    between = np.zeros(n + 1)
    between[[at, n]] = -1.0, 1.0
    for i, s in enumerate(lines.s_rad_s):
        Z = np.zeros((n + 1, n + 1), dtype=complex)
        Z[:n, :n] = s * s * model.mass + s * model.damping + model.stiffness
        Z[at, at] -= k + s * c
        Z += (k + s * c) * np.outer(between, between)
        Z[n, n] += s * s * ROTOR + (1.0 + LOSS_S * s) / SOFT * np.exp(-s * LATE_S)
        x = np.linalg.solve(Z, b)[:n]
        want = R.T @ (s * s * J[:3] @ x + np.cross(J[3:] @ x, dynamics.gravity_m_s2))
        np.testing.assert_allclose(got[m, :, i], want, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("what", ["servo delay", "servo loss"])
def test_slopes_are_those_of_differences(lines, posed, servo, values, what):
    joint, hypothesis = servo
    name = f"{what} {joint}"
    space = hypothesis.space()
    at = space.index[name]
    _, slopes = posed.derivatives(hypothesis, lines, space, values)
    step = 1e-6
    ahead, behind = (
        posed.values(hypothesis, lines, values | {name: values[name] + sign * step})
        for sign in (1, -1)
    )
    want = (ahead - behind) / (2.0 * step)
    # Single precision in the slopes.
    np.testing.assert_allclose(
        slopes[at] / space.std[at], want, rtol=1e-4, atol=1e-5 * np.abs(want).max()
    )
