"""At which joints and links of an arm an effect can be."""

from dataclasses import replace

import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.priors import UNTOLD
from armodal.protocols.arm.files import load_arm


@pytest.mark.parametrize(
    ("n_joints", "links"), [(2, [1]), (4, [2, 3]), (5, [2, 3, 4]), (6, [2, 3, 4, 5])]
)
def test_a_payload_may_hang_on_every_link_from_the_third_on(n_joints, links):
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


def test_a_bearing_is_ordinary_as_far_as_its_drive_may_be_soft():
    """A drive that nobody tells may be so many times softer than what its joint carries says."""
    arm = load_arm("bench57")
    told = arm.joints[4]
    untold = replace(told, stiffness=None, damping=None)

    def of(joint):
        joints = (*arm.joints[:4], joint, *arm.joints[5:])
        return Ordinary(superset=Superset(replace(arm, joints=joints)), postures=("p",))

    guessed = of(untold)
    softest = UNTOLD * guessed.scale(4)
    known = of(replace(told, stiffness=replace(told.stiffness, value=1.0 / softest)))
    name = f"bearing a {told.name}"
    highs = [{p.name: p.high for p in own.parameters()}[name] for own in (guessed, known)]
    assert highs[0] == pytest.approx(highs[1])
    assert guessed.bearing_limit(4) == pytest.approx(known.bearing_limit(4))
    assert guessed.bearing_limit(4) == pytest.approx(highs[0])
