import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks.rigid_design import Assembly, rigid_design
from armodal.protocols.arm.files import load_arm

JOINTS = np.deg2rad([-25.0, 20.0, 98.0, 10.0, -9.0, 30.0])


@pytest.fixture(scope="module")
def arm():
    superset = Superset(load_arm("rv4frl"))
    return superset, superset.posture(JOINTS)


def sensed(superset, dynamics, velocity):
    """What the sensors read when the superset moves, (n_points, 3)."""
    linear = dynamics.point_jacobian[:, :3] @ velocity
    return np.einsum("pba,pb->pa", dynamics.point_rotation, linear)


@pytest.mark.parametrize("assembly", list(Assembly))
def test_motion_of_joints_and_foundation_is_rigid(arm, assembly):
    superset, dynamics = arm
    design = rigid_design(superset, dynamics, assembly)
    moving = np.array(design.link) >= 0
    rng = np.random.default_rng(1)
    velocity = np.zeros(superset.n)
    velocity[[superset.joint_column(i) for i in range(6)]] = rng.standard_normal(6)
    velocity[superset.interface_columns(0)] = rng.standard_normal(6)
    read = sensed(superset, dynamics, velocity)[moving].ravel()
    rows = design.rows[moving].reshape(read.size, -1)
    solution = np.linalg.lstsq(rows, read, rcond=1e-10)[0]
    # Machine precision times a condition number of some thousands.
    np.testing.assert_allclose(rows @ solution, read, atol=1e-10)


def test_only_links_let_a_later_link_give_at_its_root(arm):
    superset, dynamics = arm
    velocity = np.zeros(superset.n)
    velocity[superset.interface_columns(3)] = [0.0, 0.0, 0.0, 1.0, 0.3, 0.0]
    rest = {}
    for assembly in Assembly:
        design = rigid_design(superset, dynamics, assembly)
        moving = np.array(design.link) >= 0
        read = sensed(superset, dynamics, velocity)[moving].ravel()
        rows = design.rows[moving].reshape(read.size, -1)
        left = read - rows @ np.linalg.lstsq(rows, read, rcond=1e-10)[0]
        rest[assembly] = np.linalg.norm(left) / np.linalg.norm(read)
    assert rest[Assembly.LINKS] < 1e-10
    assert rest[Assembly.CHAIN] > 0.1


def test_points_on_the_base_have_no_rows(arm):
    superset, dynamics = arm
    design = rigid_design(superset, dynamics, Assembly.CHAIN)
    base = np.array(design.link) < 0
    assert base.any()
    assert not design.rows[base].any()
