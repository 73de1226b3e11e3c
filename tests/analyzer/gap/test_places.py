"""At which joints and links of an arm an effect can be."""

from dataclasses import replace

import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.files import load_arm


@pytest.mark.parametrize(("n_joints", "links"), [(2, [1]), (4, [2, 3]), (5, [2, 3, 4])])
def test_short_arms_have_payloads_on_their_links_too(n_joints, links):
    arm = load_arm("bench57")
    joints = arm.joints[:n_joints]
    kept = {joint.link.name for joint in joints} | {"base"}
    points = tuple(point for point in arm.points if point.link in kept)
    short = Ordinary(superset=Superset(replace(arm, joints=joints, points=points)), postures=("p",))
    places = [i.place for i in all_instances(short) if i.effect.name == "payload"]
    assert places == [joints[i].link.name for i in links]


def test_a_compensator_stands_at_the_joints_that_lift_whether_or_not_the_first_is_rigid():
    arm = load_arm("bench57")
    rigid = replace(arm.joints[0], stiffness=None, damping=None)
    held = replace(arm, joints=(rigid, *arm.joints[1:]))
    lifting = [joint.name for joint in arm.joints[1:3]]
    for own in (arm, held):
        ordinary = Ordinary(superset=Superset(own), postures=("p",))
        places = [i.place for i in all_instances(ordinary) if i.effect.name.startswith("gravity")]
        assert places == lifting
