"""Robot descriptions as they are: everything wrong is said in one run."""

from __future__ import annotations

import math

import pytest
from support.robot_files import six_joints

from armodal.protocols.errors import ArmError
from armodal.protocols.robot.packages import find_mesh, find_package
from armodal.protocols.robot.read import read_robot
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.robot.urdf_tree import read_tree


def faults(text, folder):
    said = Remarks()
    read_tree(text, folder, said)
    return [str(one) for one in said.of("fault")]


def test_a_description_without_faults_is_read_whole(tmp_path):
    said = Remarks()
    robot = read_tree(six_joints().urdf(), tmp_path, said)
    assert said.made == []
    assert list(robot.links)[:2] == ["base_link", "shoulder"]
    assert robot.joints[1].axis.tolist() == [0.0, 1.0, 0.0]
    shoulder = robot.links["shoulder"]
    a, b = 0.16, 0.2  # a box's own moment about x, m (b² + c²) / 12
    assert shoulder.inertial.inertia_kg_m2[0, 0] == pytest.approx(
        shoulder.inertial.mass_kg * (a**2 + b**2) / 12, rel=1e-5
    )


def test_all_faults_are_told_at_once(tmp_path):
    robot = six_joints()
    robot.links[0].name = "the shoulder"
    robot.links[1].mesh, robot.links[1].scale = "a.stl", "1 -1 1"
    robot.links[2].inertial = '<inertial><mass value="heavy"/><inertia ixx="1"/></inertial>'
    robot.links[3].axis = "0 0 0"
    robot.more.append('<link name="tool0"/>')
    found = faults(robot.urdf(), tmp_path)
    for part in (
        "link 'the shoulder': wanted a name without spaces",
        "wanted right-handed axes, got the mesh scale 1 -1 1",
        "link elbow: mass value: wanted a number, got 'heavy'",
        "joint joint_4: wanted an axis with a direction",
        "link tool0: wanted a name of its own, got it twice",
    ):
        assert any(part in fault for fault in found), part


@pytest.mark.parametrize("text", ["", "<robot", "<sdf/>", "<!DOCTYPE a><robot/>", "<robot/>"])
def test_what_is_no_urdf_is_one_fault(text, tmp_path):
    assert len(faults(text, tmp_path)) == 1


def test_a_mesh_is_found_in_its_package_wherever_that_lies(tmp_path):
    mesh = tmp_path / "ws" / "arm_description" / "meshes" / "a.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_bytes(b"x")
    near = mesh.parents[1] / "urdf"
    near.mkdir()
    assert find_package("arm_description", near) == mesh.parents[1].resolve()
    for named in ("package://arm_description/meshes/a.stl", "../meshes/a.stl", f"file://{mesh}"):
        assert find_mesh(named, near).resolve() == mesh.resolve()
    # A folder that was renamed on its way is a package all the same.
    assert find_mesh("package://other_name/meshes/a.stl", near) is not None
    assert find_mesh("package://arm_description/meshes/b.stl", near) is None
    assert find_mesh("package://else/b.stl", tmp_path, [mesh.parents[2]]) is None


def test_xacro_is_expanded_with_its_packages_and_arguments(tmp_path):
    pytest.importorskip("xacrodoc")
    package = tmp_path / "arm_description"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    body = six_joints().urdf().split("\n", 1)[1].rsplit("</robot>", 1)[0]
    body = body.replace('lower="-2.5"', 'lower="${-turn * pi}"')
    (package / "urdf" / "body.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">' + body + "</robot>"
    )
    path = package / "urdf" / "arm.urdf.xacro"
    path.write_text(
        '<robot name="mine" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="turn" default="1"/><xacro:property name="turn" value="$(arg turn)"/>'
        '<xacro:include filename="$(find arm_description)/urdf/body.xacro"/></robot>'
    )
    said = Remarks()
    robot = read_robot(path, said, arguments={"turn": "0.5"})
    assert said.made == []
    assert robot.name == "mine"
    assert robot.joints[0].range_rad[0] == pytest.approx(-0.5 * math.pi)


@pytest.mark.parametrize(
    "inside",
    [
        "${1/0}",
        pytest.param("<xacro:nothing/>", marks=pytest.mark.long),
        pytest.param(
            '<xacro:include filename="$(find no_such_package)/a.xacro"/>', marks=pytest.mark.long
        ),
        "<unclosed>",
    ],
)
def test_a_broken_xacro_is_one_fault_with_its_reason(inside, tmp_path):
    pytest.importorskip("xacrodoc")
    path = tmp_path / "a.xacro"
    path.write_text(
        f'<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="x">{inside}'
        "</link></robot>"
    )
    said = Remarks()
    assert read_robot(path, said) is None
    (fault,) = said.of("fault")
    assert "wanted a xacro file that can be expanded" in fault.text
    assert "Traceback" not in fault.text


def test_a_xacro_may_name_its_robot_by_an_argument_with_a_default(tmp_path):
    pytest.importorskip("xacrodoc")
    path = tmp_path / "a.xacro"
    path.write_text(
        '<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="name" default="mine"/><link name="$(arg name)_base"/></robot>'
    )
    said = Remarks()
    assert list(read_robot(path, said).links) == ["mine_base"]
    assert list(read_robot(path, said, arguments={"name": "yours"}).links) == ["yours_base"]


def test_a_broken_xacro_names_its_arguments_without_a_value(tmp_path):
    pytest.importorskip("xacrodoc")
    path = tmp_path / "a.xacro"
    path.write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="file" '
        'default=""/><xacro:arg name="set" default="1"/><xacro:property name="v" '
        "value=\"${xacro.load_yaml('$(arg file)')}\"/><link name=\"${v['x']}\"/></robot>"
    )
    said = Remarks()
    assert read_robot(path, said) is None
    (fault,) = said.of("fault")
    assert "without a value: file, give it with --arg" in fault.text
    assert "Errno" not in fault.text


def test_a_file_of_another_kind_is_refused(tmp_path):
    path = tmp_path / "a.step"
    path.write_text("ISO-10303-21;")
    with pytest.raises(ArmError, match=r"\.urdf, \.xacro or \.xml"):
        read_robot(path, Remarks())
