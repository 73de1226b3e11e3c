"""The arm in a description: its tip, and what is held or left out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.robot_files import LinkText, scara, seven_joints, six_joints

from armodal.protocols.robot.chain import cut_chain
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.robot.urdf_tree import read_tree

GRIPPER = """
<link name="hand"/><joint name="hand_mount" type="fixed"><parent link="tool0"/><child link="hand"/>
</joint>
<link name="left_finger"/><link name="right_finger"/>
<joint name="finger_1" type="revolute"><parent link="hand"/><child link="left_finger"/>
<axis xyz="0 1 0"/><limit lower="0.1" upper="0.5"/></joint>
<joint name="finger_2" type="revolute"><parent link="hand"/><child link="right_finger"/>
<axis xyz="0 1 0"/><limit lower="0" upper="1"/><mimic joint="finger_1"/></joint>
"""


def cut(robot, tmp_path, **settings):
    said = Remarks()
    chain = cut_chain(read_tree(robot.urdf(), tmp_path, said), said, **settings)
    return chain, said


def test_fingers_are_held_and_the_flange_is_the_tip(tmp_path):
    robot = six_joints()
    robot.more.append(GRIPPER)
    chain, said = cut(robot, tmp_path)
    assert [body.name for body in chain.bodies][-1] == "flange"
    assert chain.tip == "flange"
    assert [part.link.name for part in chain.bodies[-1].parts][-1] == "right_finger"
    notes = [str(note) for note in said.of("note")]
    # Held in the middle of a range without zero: 0.3 rad.
    assert any(
        "joint finger_1" in note and f"{math.degrees(0.3):g} degrees" in note for note in notes
    )
    assert any("joint finger_2: mimics finger_1" in note for note in notes)
    assert said.of("fault") == ()


def claw(name, carrier, mimics=""):
    """A turning part of a gripper, named like nothing."""
    return (
        f'<link name="{name}"/><joint name="turn_{name}" type="revolute"><parent link="{carrier}"/>'
        f'<child link="{name}"/><limit lower="0" upper="1"/>{mimics}</joint>'
    )


def test_the_last_joint_that_others_beside_it_mimic_is_a_grippers(tmp_path):
    robot = six_joints()
    robot.more.append(claw("r1", "tool0") + claw("l1", "tool0", '<mimic joint="turn_r1"/>'))
    chain, said = cut(robot, tmp_path)
    assert [body.name for body in chain.bodies][-1] == "flange"
    assert any("turn_r1" in str(note) and "held" in str(note) for note in said.of("note"))
    assert said.of("fault") == ()


def test_chains_that_part_behind_most_joints_are_one_arm_with_fingers(tmp_path):
    robot = six_joints()
    robot.more.append(claw("r1", "tool0") + claw("l1", "tool0"))
    chain, said = cut(robot, tmp_path)
    assert (chain.tip, len(chain.bodies)) == ("flange", 6)
    assert any("taken for fingers" in str(note) for note in said.of("note"))


def test_a_tip_leaves_out_what_hangs_beyond_it(tmp_path):
    robot = six_joints()
    robot.more.append(GRIPPER)
    chain, said = cut(robot, tmp_path, tip="wrist")
    assert len(chain.bodies) == 5
    assert any("left out" in str(note) and "left_finger" in str(note) for note in said.of("note"))
    _, said = cut(robot, tmp_path, tip="nose")
    assert "wanted a link of the file, got 'nose'" in str(said.of("fault")[0])


def test_a_quill_is_held_inside_its_range_and_a_continuous_joint_gets_one(tmp_path):
    chain, said = cut(scara(), tmp_path)
    assert [body.name for body in chain.bodies] == ["arm_1", "arm_2", "spindle"]
    # Between -0.15 and -0.01 m: the spindle's joint sits 80 mm lower.
    assert chain.bodies[2].T_parent_joint[2, 3] == pytest.approx(0.05 - 0.08)
    assert chain.bodies[2].range_rad == pytest.approx((-math.pi, math.pi))
    assert any("is continuous" in guess.text for guess in said.of("guess"))


def test_two_arms_are_asked_for_a_tip(tmp_path):
    robot = six_joints()
    other = "".join(
        f'<link name="other_{i}"/><joint name="other_{i}" type="revolute"><parent link="'
        f'{"base_link" if i == 1 else f"other_{i - 1}"}"/><child link="other_{i}"/>'
        '<limit lower="-1" upper="1"/></joint>'
        for i in range(1, 7)
    )
    robot.more.append(other)
    chain, said = cut(robot, tmp_path)
    assert chain is None
    assert "give --tip, one of flange, other_6" in str(said.of("fault")[0])
    chain, said = cut(robot, tmp_path, tip="tool0")
    assert len(chain.bodies) == 6
    assert said.of("fault") == ()


def test_two_roots_and_loops_are_told(tmp_path):
    robot = six_joints()
    robot.more.append('<link name="table"/>')
    _, said = cut(robot, tmp_path)
    assert "wanted one root, got 2: base_link, table" in str(said.of("fault")[0])
    robot = six_joints()
    robot.more.append(
        '<joint name="rod" type="fixed"><parent link="shoulder"/><child link="elbow"/></joint>'
    )
    chain, said = cut(robot, tmp_path)
    assert chain is None
    assert "link elbow: wanted one parent, got two" in str(said.of("fault")[0])


def test_every_limit_that_cannot_be_is_told(tmp_path):
    robot = seven_joints()
    robot.links[1].limit = (1.0, -1.0)
    robot.links[3].limit = (-170.0, 170.0)
    _, said = cut(robot, tmp_path)
    assert [fault.where for fault in said.of("fault")] == ["joint joint_2", "joint joint_4"]
    assert "more than four turns; write rad" in said.of("fault")[1].text


def test_a_long_chain_is_refused(tmp_path):
    robot = six_joints()
    robot.links += [LinkText(f"l{i}", (0.1, 0.1, 0.1), (0, 0, 0), (0.1, 0, 0)) for i in range(4)]
    _, said = cut(robot, tmp_path)
    assert "at most 9 moving joints, found 10" in str(said.of("fault")[0])


def test_bodies_stand_where_their_joints_are(tmp_path):
    chain, _ = cut(six_joints(), tmp_path)
    places = np.array([body.T_parent_joint[:3, 3] for body in chain.bodies])
    np.testing.assert_allclose(places[:3], [[0, 0, 0.1], [0, 0, 0.2], [0, 0, 0.4]])
