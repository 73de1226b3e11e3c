"""What stands on a joint's axis is on either link of that joint, and told as one."""

import numpy as np
import pytest
from support.bench_effects import instance_of, start_of

from armodal.analyzer.gap.model.hypothesis import Hypothesis


@pytest.mark.parametrize("off_m", [0.0, 0.08])
def test_a_damper_that_ends_on_a_joints_axis_is_on_both_its_links(ordinary, lines, posed, off_m):
    """Its effect is one then, and told as one; beside the axis it is on one of them."""
    far = [
        instance_of(ordinary, "nonproportional", f"floor and {n}") for n in ("knuckle", "fore_tube")
    ]
    joint = ordinary.arm.joints[3]
    end = np.array([off_m, 0.0, 0.1])  # its axis is z
    T = joint.T_parent_joint
    ends = [T[:3, :3] @ end + T[:3, 3], end]
    found, one = [], []
    for instance, other, place in zip(far, far[::-1], ends, strict=True):
        hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
        values = start_of(hypothesis) | {instance.size: 700.0}
        values |= dict(zip(instance.shapes[3:], place.tolist(), strict=True))
        found.append(posed.system(hypothesis, lines, values).damping)
        one.append(instance.is_also(values, other))
    of_joints = [C[: len(ordinary.elastic), : len(ordinary.elastic)] for C in found]
    alike = np.allclose(*of_joints, rtol=1e-6, atol=1e-6 * np.abs(of_joints[0]).max())
    assert one == [alike] * 2 == [off_m == 0.0] * 2


@pytest.mark.parametrize("off_m", [0.0, 0.08])
def test_a_body_on_a_joints_axis_is_on_both_its_links(ordinary, lines, posed, off_m):
    """A point mass there moves as if on either link; beside the axis the joint turns it."""
    joints = ordinary.arm.joints[4:]
    at_m = np.array([off_m, 0.0, 0.0])  # the axis of the last joint is z
    T = joints[1].T_parent_joint
    places = [T[:3, :3] @ at_m + T[:3, 3], at_m]
    both = [instance_of(ordinary, "payload", joint.link.name) for joint in joints]
    masses, one = [], []
    for joint, instance, other, place in zip(joints, both, both[::-1], places, strict=True):
        hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
        mass, *rest = (p.name for p in instance.parameters)
        moments, radius = rest[:3], rest[3]
        values = start_of(hypothesis) | {mass: 1.0, radius: 0.0}
        first = (place - joint.link.center_m).tolist()
        values |= dict(zip(moments, first, strict=True))
        system = posed.system(hypothesis, lines, values)
        masses.append(system.mass[: len(ordinary.elastic), : len(ordinary.elastic)])
        one.append(instance.is_also(values, other))
        further = instance_of(ordinary, "payload", ordinary.arm.joints[2].link.name)
        assert not instance.is_also(values, further)
    alike = np.allclose(*masses, rtol=1e-6, atol=1e-6 * np.abs(masses[0]).max())
    assert one == [alike] * 2 == [off_m == 0.0] * 2
