import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.shape_motion import ShapeMotion, measured_motion
from armodal.protocols.arm.files import load_arm
from armodal.protocols.frf_records import Dof

ARM = load_arm("rv4frl")
ANGLES = np.array([0.1, -0.4, 0.9, 0.3, -0.5, 0.2])
RIDGE = 1e-2  # the ridge of 1e-3 gives up about its square, times the spread of the arm's levers


def _made_shape():
    superset = Superset(ARM)
    posture = superset.posture(ANGLES)
    dofs = tuple(
        Dof(point=p.id, label=label, direction=posture.point_rotation[i][:, k])
        for i, p in enumerate(ARM.points)
        for k, label in enumerate("xyz")
    )
    measured = MeasuredModes(superset, posture, (), dofs)
    q = np.array([1.0, -0.5, 0.8, 0.0, 0.0, 0.0]) * np.exp(0.3j)
    columns = [superset.joint_column(i) for i in range(6)]
    return superset, posture, measured, posture.point_jacobian[:, :3, columns] @ q


def test_a_motion_of_joints_is_carried_to_every_place_on_the_arm():
    _, _, measured, motion = _made_shape()
    shape = np.einsum("ri,ri->r", measured.directions, motion[measured.index])
    names = [joint.link.name for joint in ARM.joints]
    link = [names.index(p.link) if p.link in names else -1 for p in ARM.points]
    carrier = ShapeMotion(ARM, ANGLES, link, np.array([p.position_m for p in ARM.points]))
    carried = carrier.motion(measured, shape)
    assert np.abs(carried - motion).max() < RIDGE * np.abs(motion).max()


def test_measured_points_move_as_measured():
    _, _, measured, motion = _made_shape()
    shape = np.einsum("ri,ri->r", measured.directions, motion[measured.index])
    # rounding of a well-conditioned 3 x 3 solve
    assert measured_motion(measured, shape, len(ARM.points)) == pytest.approx(motion, abs=1e-12)


def test_a_point_that_was_not_measured_does_not_move_in_the_record():
    superset, posture, _, _ = _made_shape()
    dofs = (Dof(point=ARM.points[0].id, label="x", direction=np.array([1.0, 0.0, 0.0])),)
    one = MeasuredModes(superset, posture, (), dofs)
    moved = measured_motion(one, np.array([2.0 + 0j]), len(ARM.points))
    assert moved[0] == pytest.approx([2.0, 0.0, 0.0], abs=1e-12)  # rounding
    assert not moved[1:].any()
