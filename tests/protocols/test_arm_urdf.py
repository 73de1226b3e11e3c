from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from armodal.protocols.arm.files import ARMS_DIRECTORY
from armodal.protocols.arm.urdf import read_urdf, rotation_rpy
from armodal.protocols.errors import ArmError

INERTIAL = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>'
)
JOINT = (
    '<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{child}"/>'
    '<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 2"/><limit lower="-1" upper="1"/></joint>'
)


def joint(
    name: str,
    parent: str,
    child: str,
    *,
    kind: str = "revolute",
    xyz: str = "0 0 0.5",
    rpy: str = "0 0 0",
) -> str:
    return JOINT.format(name=name, type=kind, parent=parent, child=child, xyz=xyz, rpy=rpy)


def robot(*parts: str) -> str:
    return '<robot name="r">' + "".join(parts) + "</robot>"


def link(name: str, inertial: str = INERTIAL) -> str:
    return f'<link name="{name}">{inertial}</link>'


SIMPLE = robot(link("base", ""), link("a"), joint("j1", "base", "a"))


def test_a_simple_chain_is_read() -> None:
    chain = read_urdf(SIMPLE)
    assert (chain.name, chain.base) == ("r", "base")
    (only,) = chain.joints
    assert only.axis.tolist() == [0.0, 0.0, 1.0]
    assert only.T_parent_joint[:3, 3].tolist() == [0.0, 0.0, 0.5]
    assert only.range_rad == (-1.0, 1.0)
    assert only.link.mass_kg == 2.0
    assert not only.link.inertia_kg_m2.flags.writeable


def test_the_shipped_urdf_weighs_what_its_source_says() -> None:
    text = (ARMS_DIRECTORY / "rv4frl.urdf").read_text(encoding="utf-8")
    masses = [j.link.mass_kg for j in read_urdf(text).joints]
    # "moving mass 26.4 kg" in the project's reference, printed to a tenth.
    assert sum(masses) == pytest.approx(26.4, abs=0.05)


def test_roll_pitch_yaw_turn_about_fixed_axes() -> None:
    # A quarter turn about x, then one about the fixed z: y goes to z and stays there.
    R = rotation_rpy(math.pi / 2, 0.0, math.pi / 2)
    np.testing.assert_allclose(R @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(R @ [1, 0, 0], [0, 1, 0], atol=1e-15)


def test_a_turned_inertial_is_brought_into_link_axes() -> None:
    turned = INERTIAL.replace('xyz="0 0 0.1"', f'xyz="0 0 0.1" rpy="{math.pi / 2} 0 0"')
    chain = read_urdf(robot(link("base", ""), link("a", turned), joint("j1", "base", "a")))
    # Its z moment now lies along y.
    expected = np.diag([0.02, 0.01, 0.02])
    np.testing.assert_allclose(chain.joints[0].link.inertia_kg_m2, expected, atol=1e-15)


def test_links_on_fixed_joints_are_merged() -> None:
    text = robot(
        link("world", ""), link("base", ""), link("a"), link("tool"), link("tip", ""),
        joint("f0", "world", "base", kind="fixed", xyz="0 0 1"),
        joint("j1", "base", "a"),
        joint("f1", "a", "tool", kind="fixed", xyz="0 0.4 0"),
        joint("f2", "tool", "tip", kind="fixed"),
    )  # fmt: skip
    (only,) = read_urdf(text).joints
    assert only.T_parent_joint[:3, 3].tolist() == [0.0, 0.0, 1.5]
    assert only.link.mass_kg == 4.0
    np.testing.assert_allclose(only.link.center_m, [0.0, 0.2, 0.1], atol=1e-15)
    # Two bodies of 2 kg, each 0.2 m off in y: 2 * 2 * 0.04 = 0.16 more about x and z.
    expected = np.diag([0.04 + 0.16, 0.04, 0.02 + 0.16])
    np.testing.assert_allclose(only.link.inertia_kg_m2, expected, atol=1e-15)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "wanted XML"),
        ("<robot", "wanted XML"),
        ("<a/>", "wanted the root element robot"),
        (robot(link("base", "")), "wanted 2 to 64 links"),
        (robot(link("base"), link("base")), "every link with a name of its own, got 'base'"),
        (SIMPLE.replace("revolute", "prismatic"), "j1: wanted type revolute, continuous or fixed"),
        (SIMPLE.replace('type="revolute"', ""), "j1: wanted type revolute, continuous or fixed"),
        (SIMPLE.replace('child link="a"', 'child link="b"'), "joint j1: wanted a child link"),
        (SIMPLE.replace("0 0 2", "0 0 0"), "joint j1: wanted an axis with a direction"),
        (SIMPLE.replace("0 0 2", "0 2"), "joint j1: axis xyz: wanted 3 numbers"),
        (SIMPLE.replace('lower="-1"', 'lower="1"'), "joint j1: wanted limit lower < upper"),
        (SIMPLE.replace('lower="-1"', 'lower="nan"'), "joint j1: limit lower: wanted a finite"),
        (SIMPLE.replace('<limit lower="-1" upper="1"/>', ""), "joint j1: wanted a limit"),
        (SIMPLE.replace(INERTIAL, ""), "link a: wanted an inertial, got none"),
        (SIMPLE.replace('<mass value="2"/>', ""), "link a: wanted <mass value=...>, got none"),
        (SIMPLE.replace('value="2"', 'value="-2"'), "link a: wanted a mass above 0 kg, got -2.0"),
        (SIMPLE.replace('value="2"', 'value="0"'), "link a: wanted a mass above 0 kg, got 0.0"),
        (SIMPLE.replace('value="2"', 'value="2_0x"'), "link a: mass: wanted a finite number"),
        (SIMPLE.replace('ixx="0.02"', 'ixx="0"'), "link a: wanted a positive definite inertia"),
        (SIMPLE.replace('ixy="0"', 'ixy="0.03"'), "link a: wanted a positive definite inertia"),
        (SIMPLE.replace('izz="0.01"', 'izz="0.05"'), "link a: wanted principal moments of which"),
        (
            robot(link("base", ""), link("a"), link("b"), joint("j1", "base", "a"),
                  joint("j2", "base", "b")),
            "wanted a serial chain, got a branch at base: j1, j2",
        ),
        (
            robot(link("base", ""), link("a"), link("b"), joint("j1", "base", "a"),
                  joint("j2", "b", "a")),
            "joint j2: wanted a link with one parent",
        ),
        (
            robot(link("base", ""), link("c"), link("a"), link("b"), joint("j0", "base", "c"),
                  joint("j1", "a", "b"), joint("j2", "b", "a")),
            "wanted every link on the chain, got 2 in a loop",
        ),
        (robot(link("base"), link("a")), "wanted one link without a parent, got 2"),
        (SIMPLE.replace("revolute", "fixed"), "wanted at least one revolute joint"),
        ("<robot>" + "<a>" * 40 + "</a>" * 40 + "</robot>", "at most 32 deep"),
        ('<!DOCTYPE robot [<!ENTITY a "b">]>' + SIMPLE, "wanted plain XML, got a document type"),
        ('<!DOCTYPE robot SYSTEM "http://localhost/x.dtd">' + SIMPLE, "got a document type"),
        (SIMPLE.replace('name="r"', 'name="&undefined;"'), "wanted XML"),
    ],
)  # fmt: skip
def test_what_is_no_arm_is_refused_by_name(text: str, said: str) -> None:
    with pytest.raises(ArmError) as caught:
        read_urdf(text)
    assert said in str(caught.value)


def test_entities_are_never_expanded() -> None:
    levels = "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
    bomb = f'<!DOCTYPE r [<!ENTITY e0 "ha">{levels}]><robot name="&e9;"/>'
    with pytest.raises(ArmError, match="document type"):
        read_urdf(bomb)


def test_a_continuous_joint_has_no_range() -> None:
    chain = read_urdf(SIMPLE.replace("revolute", "continuous"))
    assert chain.joints[0].range_rad == (-math.inf, math.inf)


@settings(max_examples=examples(60))
@given(st.data())
def test_a_urdf_with_a_stretch_replaced_is_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(SIMPLE)))
    length = data.draw(st.integers(0, 12))
    junk = data.draw(st.text(max_size=12))
    with contextlib.suppress(ArmError):
        read_urdf(SIMPLE[:start] + junk + SIMPLE[start + length :])
