import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.geometry import GeometryNear
from armodal.hil_sim.study import study_arm

STEP_RAD = 1e-5


@pytest.mark.parametrize("name", ["bench57", pytest.param("ur5", marks=pytest.mark.long)])
def test_slopes_are_those_of_the_geometry(name):
    superset = Superset(study_arm(name).arm)
    q = np.array([0.3, -0.8, 1.1, 0.4, -0.6, 0.9])
    slopes = GeometryNear(superset, q).slopes()
    for joint in range(6):
        ends = []
        for side in (1.0, -1.0):
            there = q + side * STEP_RAD * np.eye(6)[joint]
            ends.append(superset.posture(there))
        for kind in ("link_jacobian", "point_jacobian", "point_rotation"):
            by_steps = (getattr(ends[0], kind) - getattr(ends[1], kind)) / (2.0 * STEP_RAD)
            # Central differences: step^2 of truncation, 1e-16 / step of rounding.
            assert getattr(slopes, kind)[joint] == pytest.approx(by_steps, abs=1e-9)


def test_far_from_its_centre_the_geometry_is_made_anew():
    superset = Superset(study_arm("bench57").arm)
    q = np.array([0.3, -0.8, 1.1, 0.4, -0.6, 0.9])
    near = GeometryNear(superset, q)
    offset = np.array([0.2, 0.0, -0.1, 0.0, 0.0, 0.3])
    there = near.at(offset)
    # Its own centre: no slope is in it.
    assert there.point_jacobian == pytest.approx(superset.posture(q + offset).point_jacobian)
    # One joint by 0.01 rad more: the second order is 5e-5 of a lever, which are below 1.5 m.
    more = offset + 0.01 * np.eye(6)[1]
    beside, exact = near.at(more), superset.posture(q + more)
    assert beside.point_jacobian == pytest.approx(exact.point_jacobian, abs=1e-4)
    assert np.max(np.abs(exact.point_jacobian - there.point_jacobian)) > 3e-3
