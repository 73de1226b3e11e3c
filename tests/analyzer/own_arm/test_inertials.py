"""Inertials: what is doubted, what is projected, what is guessed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.robot_files import six_joints

from armodal.analyzer.own_arm.bodies import arm_bodies
from armodal.analyzer.own_arm.guess import believed_links, guessed_inertial
from armodal.analyzer.own_arm.plausible import doubted, nearest_body
from armodal.protocols.robot.chain import cut_chain
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.robot.urdf_tree import read_tree


def looked(robot, folder, total_kg=None):
    said = Remarks()
    chain = cut_chain(read_tree(robot.urdf(), folder, said), said)
    bodies = arm_bodies(chain, said)
    assert said.of("fault") == ()
    doubts = doubted(bodies, said, total_kg=total_kg)
    return bodies, doubts, said


def inertial(mass, ixx, iyy, izz, xyz="0 0 0"):
    return (
        f'<inertial><origin xyz="{xyz}"/><mass value="{mass}"/><inertia ixx="{ixx}" iyy="{iyy}" '
        f'izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def test_believable_inertials_raise_no_doubt_and_are_kept(tmp_path):
    robot = six_joints()
    bodies, doubts, said = looked(robot, tmp_path)
    assert said.of("doubt") == ()
    believed = believed_links(bodies, doubts, said)
    assert believed.guessed == ()
    assert [link.mass_kg for link in believed.links] == pytest.approx(
        [link.mass() for link in robot.links], rel=1e-5
    )
    assert believed.inertia == 0.1


def test_links_of_one_kilogram_and_one_metre_are_doubted_each_and_all_told(tmp_path):
    robot = six_joints()
    for link in robot.links:
        link.inertial = inertial(1, 1, 1, 1)
    _, doubts, said = looked(robot, tmp_path)
    assert doubts.mass == {link.name for link in robot.links}
    told = [str(doubt) for doubt in said.of("doubt")]
    assert sum("placeholder" in doubt for doubt in told) == 6
    assert sum("outside its surface" in doubt for doubt in told) == 6
    assert sum("one and the same mass" in doubt for doubt in told) == 1


def test_a_wrist_of_that_radius_loses_its_spread_and_keeps_its_mass(tmp_path):
    robot = six_joints()
    wrist = robot.links[4]
    wrist.inertial = inertial(1.2, 0.111, 0.111, 0.216)  # radius of gyration 0.42 m
    bodies, doubts, said = looked(robot, tmp_path)
    assert doubts.spread == {"wrist"}
    assert doubts.mass == frozenset()
    assert "radii of gyration 0.304, 0.304, 0.424 m" in str(said.of("doubt")[0])
    believed = believed_links(bodies, doubts, said)
    assert believed.guessed == ("wrist",)
    assert believed.links[4].mass_kg == 1.2
    # One guessed spread is not that of the links around it.
    assert [std.inertia for std in believed.stds] == [0.1] * 4 + [0.47, 0.1]
    assert believed.moving_mass is None
    a, b, c = np.square(wrist.box_m)
    np.testing.assert_allclose(
        np.diag(believed.links[4].inertia_kg_m2), 1.2 / 12 * np.array([b + c, a + c, a + b])
    )


def test_an_arm_of_solid_metal_is_doubted_and_the_data_sheet_decides(tmp_path):
    robot = six_joints()
    for link in robot.links:
        link.mass_kg = 2.1 * link.mass()  # 2520 kg/m³ over the hulls
    _, doubts, said = looked(robot, tmp_path)
    assert len(doubts.mass) == 6
    assert "nearly solid metal" in str(said.of("doubt")[0])
    whole = sum(link.mass() for link in robot.links)
    robot = six_joints()
    bodies, doubts, said = looked(robot, tmp_path, total_kg=0.4 * whole)
    assert len(doubts.mass) == 6
    assert "the data sheet's mass is" in str(said.of("doubt")[0])
    believed = believed_links(bodies, doubts, said, total_kg=0.4 * whole)
    base_share = 0.4 * whole - sum(link.mass_kg for link in believed.links)
    assert 0.0 < base_share < 0.4 * 0.4 * whole
    assert [std.mass for std in believed.stds] == [0.35] * 5 + [0.6]


def test_a_centre_off_the_body_and_all_mass_in_one_spot_are_doubted(tmp_path):
    robot = six_joints()
    robot.links[1].inertial = inertial(5, 0.09, 0.09, 0.02, xyz="0.4 0 0.2")
    robot.links[3].inertial = inertial(3, 1e-6, 1e-6, 1e-6, xyz="0.16 0 0")
    _, doubts, said = looked(robot, tmp_path)
    assert doubts.spread >= {"upper_arm", "forearm"}
    told = [str(doubt) for doubt in said.of("doubt")]
    assert any("upper_arm: its centre of mass is 340 mm outside" in doubt for doubt in told)
    assert any("forearm" in doubt and "one spot" in doubt for doubt in told)


def test_a_near_miss_becomes_the_nearest_body_and_is_said(tmp_path):
    inertia = np.diag([0.01, 0.02, 0.03 * 1.0075])
    nearest, excess = nearest_body(inertia)
    assert excess == pytest.approx(0.0075)
    moments = np.linalg.eigvalsh(nearest)
    assert moments[2] <= (moments[0] + moments[1]) * (1 + 1e-12)
    # The excess, 0.000225, is a negative mean square of half of it: taken away, it is shared.
    added = np.array([0.0001125, 0.0001125, 0.0])
    np.testing.assert_allclose(np.diag(nearest), np.diag(inertia) + added)
    robot = six_joints()
    robot.links[2].inertial = inertial(2.8, 0.0025, 0.005, 0.0075 * 1.0075)
    bodies, doubts, said = looked(robot, tmp_path)
    assert doubts.spread == frozenset()
    assert believed_links(bodies, doubts, said).guessed == ()
    assert any(
        "exceeds the sum of the other two by 0.75 %" in note.text for note in said.of("note")
    )


def test_missing_inertials_share_what_the_data_sheet_leaves(tmp_path):
    robot = six_joints()
    robot.with_inertials = False
    bodies, doubts, said = looked(robot, tmp_path, total_kg=30.0)
    assert doubts.mass == frozenset()
    believed = believed_links(bodies, doubts, said, total_kg=30.0)
    assert len(believed.guessed) == 6
    moving = sum(link.mass_kg for link in believed.links)
    assert 0.5 * 30.0 < moving < 30.0
    # A compact link is denser than a long one (docs/own-arm.md).
    density = {
        link.name: link.mass_kg / np.prod(text.box_m)
        for link, text in zip(believed.links, robot.links, strict=True)
    }
    assert density["elbow"] > 1.3 * density["upper_arm"]
    assert any("by share of 30 kg" in guess.text for guess in said.of("guess"))
    without = believed_links(bodies, doubts, Remarks())
    assert without.moving_mass is None
    assert [std.mass for std in without.stds] == [0.45] * 5 + [0.6]
    # The base may have taken of the links' mass, or they of its; together they are the 30 kg.
    base = 0.35 * (30.0 - moving)
    assert 0.02 < believed.moving_mass < base / moving + 0.02 * 30.0 / moving
    # A centre is known to a part of its own link's length.
    centers = [std.center_m for std in believed.stds]
    assert centers == [max(0.005, 0.08 * max(link.box_m)) for link in robot.links]


def test_a_picture_with_parts_far_off_gives_way_to_the_shape_to_run_into(tmp_path):
    robot = six_joints()
    seen = '<visual><geometry><box size="9 0.1 0.1"/></geometry></visual>'
    text = robot.urdf()
    start = text.index("<visual>", text.index('<link name="forearm">'))
    text = text[:start] + seen + text[text.index("</visual>", start) + len("</visual>") :]
    said = Remarks()
    bodies = arm_bodies(cut_chain(read_tree(text, tmp_path, said), said), said)
    forearm = next(body for body in bodies if body.name == "forearm")
    assert forearm.seen.size_m == max(robot.links[3].box_m)
    (note,) = (note.text for note in said.of("note"))
    assert "got 9 m; the link's other shapes serve" in note
    assert said.of("fault") == ()


def test_masses_that_miss_the_data_sheet_by_less_than_a_guess_would_are_scaled(tmp_path):
    robot = six_joints()
    bodies, _, _ = looked(robot, tmp_path)
    base = replace(bodies[0], inertial=guessed_inertial(bodies[0].seen, 4.0))
    bodies = (base, *bodies[1:])
    whole = 4.0 + sum(link.mass() for link in robot.links)
    for factor, kept in ((1.2, True), (2.0, False)):
        said = Remarks()
        doubts = doubted(bodies, said, total_kg=factor * whole)
        assert "the data sheet's mass is" in str(said.of("doubt")[0])
        believed = believed_links(bodies, doubts, said, total_kg=factor * whole)
        assert (believed.guessed == ()) is kept
        if kept:
            assert [link.mass_kg for link in believed.links] == pytest.approx(
                [factor * link.mass() for link in robot.links], rel=1e-5
            )
            assert believed.mass == pytest.approx(math.log(factor))


def test_a_base_that_is_a_pedestal_is_not_weighed_with_the_arm(tmp_path):
    robot = six_joints()
    bodies, _, _ = looked(robot, tmp_path)
    moving = sum(link.mass() for link in robot.links)
    pedestal = replace(bodies[0], inertial=guessed_inertial(bodies[0].seen, 10.0 * moving))
    said = Remarks()
    doubts = doubted((pedestal, *bodies[1:]), said, total_kg=moving)
    assert said.of("doubt") == ()
    bare = [replace(body, inertial=None) for body in bodies[1:]]
    believed = believed_links((pedestal, *bare), doubts, said, total_kg=moving)
    assert sum(link.mass_kg for link in believed.links) == pytest.approx(moving)
    assert any("too heavy or too large for an arm's base" in str(n) for n in said.of("note"))
