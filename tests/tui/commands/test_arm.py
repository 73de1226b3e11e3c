"""`armodal arm`: from a robot description to an arm file, faults told in one message."""

from __future__ import annotations

import json
import math
import shutil

import numpy as np
import pytest
from support.command import armodal
from support.robot_files import box_stl, five_joints, scara, seven_joints, six_joints
from typer.testing import CliRunner

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.plan import load_plan
from armodal.tui.cli import app


def refused(said, *parts):
    assert said.returncode == 2, said.stderr
    assert said.stderr.count("armodal:") == 1
    assert "Traceback" not in said.stderr
    for part in parts:
        assert part in said.stderr, part
    return said.stderr


@pytest.mark.parametrize(
    ("robot", "joints"),
    [
        pytest.param(six_joints, 6, marks=pytest.mark.long),
        pytest.param(five_joints, 5, marks=pytest.mark.long),
        pytest.param(seven_joints, 7, marks=pytest.mark.long),
        (scara, 3),
    ],
)
def test_an_arm_is_made_that_loads_and_stands_as_described(robot, joints, tmp_path):
    text = robot()
    path = text.write(tmp_path / "robot.urdf")
    said = armodal("arm", "new", path, "--yes", "--no-plan", "--out", tmp_path / "mine", "--json")
    assert said.returncode == 0, said.stderr
    told = json.loads(said.stdout)
    arm = load_arm(tmp_path / "mine" / "robot.toml")
    assert len(arm.joints) == joints == len(told["joints"])
    for joint, link in zip(told["joints"], arm.joints, strict=True):
        assert joint == link.name
    described = {link.name: link.mass() for link in text.links}
    held = described.pop("quill", 0.0)  # held by the second arm
    for joint in arm.joints:
        extra = held if joint.link.name == "arm_2" else 0.0
        expected = described[joint.link.name] + extra
        assert joint.link.mass_kg == pytest.approx(expected, rel=1e-5)
    counts = [len(ids) for ids in told["points"].values()]
    assert counts[0] == 2
    assert min(counts[1:]) >= 3
    page = (tmp_path / "mine" / "points.html").read_text()
    assert all(f'"{point.id}"' in page for point in arm.points)
    assert "Content-Security-Policy" in page
    readme = (tmp_path / "mine" / "README.md").read_text()
    assert all(guess in readme for guess in told["guesses"])
    assert all(guess in arm.text for guess in told["guesses"])
    # A check of what was made has nothing to say.
    assert armodal("arm", "check", tmp_path / "mine" / "robot.toml").returncode == 0


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A new arm's folder."""
    folder = tmp_path_factory.mktemp("made")
    path = six_joints().write(folder / "robot.urdf")
    said = armodal("arm", "new", path, "--yes", "--no-plan", "--out", folder / "mine")
    assert said.returncode == 0, said.stderr
    return folder / "mine"


def test_the_new_arm_s_flange_is_where_the_description_has_it(made):
    arm = load_arm(made / "robot.toml")
    # Upper arm forward by a quarter turn: elbow 0.4 m along x, at the second joint's height.
    T = link_pose(arm, "elbow", [0.0, math.pi / 2, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(T[:3, 3], [0.4, 0.0, 0.3], atol=1e-9)


def test_mounting_mass_and_missing_inertials_are_taken_and_said(tmp_path):
    robot = six_joints()
    robot.with_inertials = False
    path = robot.write(tmp_path / "robot.urdf")
    said = armodal(
        "arm", "new", path, "--yes", "--no-plan", "--mass", 28,
        "--mount", "ceiling", "--name", "up there",
        "--out", tmp_path / "mine",
    )  # fmt: skip
    assert said.returncode == 0, said.stderr
    arm = load_arm(tmp_path / "mine" / "up-there.toml")
    assert arm.gravity_m_s2.tolist() == [0.0, 0.0, 9.80665]
    assert sum(joint.link.mass_kg for joint in arm.joints) < 28.0
    # The last link's mass is known least; what the arm's links have together is known better.
    assert [joint.inertial_std.mass for joint in arm.joints] == [0.35] * 5 + [0.6]
    assert 0.02 < arm.tolerances.moving_mass < 0.2
    assert said.stderr.count("guess: link") == 6
    assert "next: read" in said.stderr.splitlines()[-1]
    told = armodal("arm", "check", tmp_path / "mine" / "up-there.toml", "--json")
    assert [row["inertial"] for row in json.loads(told.stdout)["links"][1:]] == ["guessed"] * 6


def test_every_fault_is_in_one_message_and_nothing_is_written(tmp_path):
    robot = six_joints()
    robot.links[0].mesh = "nowhere.stl"
    robot.links[1].mesh = box_stl(tmp_path / "mm.stl", (120.0, 100.0, 450.0)).name
    (tmp_path / "broken.stl").write_bytes(b"solid")
    robot.links[3].mesh = "broken.stl"
    path = robot.write(tmp_path / "robot.urdf")
    before = sorted(tmp_path.iterdir())
    for command in (
        ("new", path, "--yes", "--no-plan", "--out", tmp_path / "mine"),
        ("check", path),
    ):
        refused(
            armodal("arm", *command),
            "link shoulder: wanted the mesh 'nowhere.stl', found no such file",
            'a mesh in mm needs scale="0.001 0.001 0.001"',
            "link forearm: visual: mesh broken.stl: wanted a mesh that can be read",
        )
    assert sorted(tmp_path.iterdir()) == before
    assert armodal("arm", "check", path, "--no-meshes").returncode == 0


def test_faults_of_the_tree_do_not_hide_those_of_meshes(tmp_path):
    robot = six_joints()
    robot.links[0].mesh = "nowhere.stl"
    robot.links[2].name = "the elbow"
    robot.more.append('<link name="table"/>')
    refused(
        armodal("arm", "check", robot.write(tmp_path / "robot.urdf")),
        "wanted one root, got 2",
        "'the elbow': wanted a name without spaces",
        "wanted the mesh 'nowhere.stl'",
    )


def test_an_open_mesh_serves_by_its_hull(tmp_path):
    robot = six_joints()
    link = robot.links[2]
    link.mesh = box_stl(tmp_path / "open.stl", link.box_m, without=1).name
    path = robot.write(tmp_path / "robot.urdf")
    said = armodal("arm", "check", path, "--json")
    assert said.returncode == 0
    assert any(
        "elbow: 2 of its 2 shapes are not closed" in note
        for note in json.loads(said.stdout)["notes"]
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--mount", "table"), "--mount: wanted floor, ceiling, wall"),
        (("--mount", "0,0,1"), "wanted gravity of some 9.81"),
        (("--arg", "dof=6"), "--arg: wanted NAME:=VALUE"),
        (("--arg", "dof:=6"), "xacro arguments with a .xacro file only"),
        (("--tip", "nose"), "wanted a link of the file, got 'nose'"),
    ],
)
def test_options_that_cannot_be_meant_are_refused(options, words, tmp_path):
    path = six_joints().write(tmp_path / "robot.urdf")
    refused(
        armodal("arm", "new", path, "--yes", "--no-plan", "--out", tmp_path / "mine", *options),
        words,
    )
    assert not (tmp_path / "mine").exists()


def test_a_folder_that_is_there_is_never_replaced(tmp_path):
    path = six_joints().write(tmp_path / "robot.urdf")
    (tmp_path / "mine").mkdir()
    refused(
        armodal("arm", "new", path, "--yes", "--no-plan", "--out", tmp_path / "mine"),
        "exists already",
    )


def test_doubts_end_a_check_and_the_new_arm_replaces_them(tmp_path):
    robot = six_joints()
    for link in robot.links:
        link.inertial = (
            '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" '
            'iyz="0"/></inertial>'
        )
    path = robot.write(tmp_path / "robot.urdf")
    refused(armodal("arm", "check", path), "looks like a placeholder", "correct the description")
    said = armodal("arm", "new", path, "--yes", "--no-plan", "--out", tmp_path / "mine")
    assert said.returncode == 0
    arm = load_arm(tmp_path / "mine" / "robot.toml")
    assert max(np.linalg.eigvalsh(j.link.inertia_kg_m2)[2] for j in arm.joints) < 0.5
    assert "placeholder" in arm.text
    kept = armodal(
        "arm", "new", path, "--yes", "--no-plan", "--keep-inertials", "--out", tmp_path / "kept"
    )
    assert kept.returncode == 0
    assert load_arm(tmp_path / "kept" / "robot.toml").joints[0].link.mass_kg == 1.0


def test_a_point_far_off_its_link_is_refused(made, tmp_path):
    file = shutil.copytree(made, tmp_path / "mine") / "robot.toml"
    lines = file.read_text().split("\n")
    first = next(i for i, line in enumerate(lines) if line.startswith("position_m"))
    lines[first] = "position_m = [0.3, 0.0, 0.0]"
    file.write_text("\n".join(lines))
    refused(armodal("arm", "check", file), "point 1: wanted it on link flange", "mm off")


def test_an_arm_file_is_checked_without_its_meshes(made, tmp_path):
    file = shutil.copytree(made, tmp_path / "mine") / "robot.toml"
    shutil.rmtree(file.parent / "meshes")
    refused(armodal("arm", "check", file), "--no-meshes")
    said = armodal("arm", "check", file, "--no-meshes", "--json")
    assert said.returncode == 0, said.stderr
    rows = json.loads(said.stdout)["links"]
    assert {row["shape"] for row in rows} == {"capsule"}


def test_shipped_arms_are_checked_by_capsules():
    said = armodal("arm", "check", "ur5", "--json")
    assert said.returncode == 0, said.stderr
    rows = json.loads(said.stdout)["links"]
    assert {row["shape"] for row in rows} == {"capsule"}


def test_a_new_arm_comes_with_a_plan_that_its_file_can_run(tmp_path, small_search):
    path = five_joints().write(tmp_path / "robot.urdf")
    said = armodal("arm", "new", path, "--yes", "--out", tmp_path / "mine", "--json")
    assert said.returncode == 0, said.stderr
    told = json.loads(said.stdout)
    arm = load_arm(tmp_path / "mine" / "robot.toml")
    plan = load_plan(tmp_path / "mine" / "plan.toml", arm)
    assert plan.trigger.level_n == told["plan"]["equipment"]["trigger_n"]
    assert told["plan"]["minutes"] > 0
    (box,) = arm.keep_outs
    assert box.high_m[2] == 0.0  # the base stands on it
    # What was made is planned again from its own files, and needs no folder of the description.
    path.unlink()
    again = armodal("plan", tmp_path / "mine" / "robot.toml", "--tests", 3, "--json")
    assert again.returncode == 0, again.stderr
    assert json.loads(again.stdout)["by_capsules"] is False


def test_on_a_terminal_it_asks_what_only_the_user_knows(tmp_path, monkeypatch):
    monkeypatch.setattr("armodal.tui.commands.arm.on_terminal", lambda: True)
    robot = six_joints()
    robot.links[4].inertial = (
        '<inertial><mass value="1.2"/><inertia ixx="0.1" iyy="0.1" izz="0.2" ixy="0" ixz="0" '
        'iyz="0"/></inertial>'
    )
    path = robot.write(tmp_path / "robot.urdf")
    answers = "wrist\n0\nceiling\ny\n"  # tip, mass unknown, mounting, replace doubted inertials
    asked = CliRunner().invoke(
        app, ["arm", "new", str(path), "--no-plan", "--out", str(tmp_path / "mine")], input=answers
    )
    assert asked.exit_code == 0, asked.output
    assert asked.stderr.count("[") >= 4  # each question shows its default
    arm = load_arm(tmp_path / "mine" / "robot.toml")
    assert len(arm.joints) == 5
    assert arm.gravity_m_s2[2] > 0
    assert arm.joints[4].link.mass_kg == pytest.approx(1.2)
    assert np.linalg.eigvalsh(arm.joints[4].link.inertia_kg_m2)[2] < 0.01


@pytest.fixture
def mine(made, tmp_path):
    """A new arm's file that may be changed."""
    return shutil.copytree(made, tmp_path / "mine") / "robot.toml"


def points_of(arm, link):
    return [point for point in arm.points if point.link == link]


def test_a_point_is_moved_along_its_face_by_an_offset(mine):
    first = points_of(load_arm(mine), "upper_arm")[0]
    axis = int(np.argmax(np.abs(first.R_link_sensor[:, 2])))
    along = 2 if axis != 2 else 0
    step = np.zeros(3)
    step[along] = -0.02 if first.position_m[along] > {0: 0.0, 2: 0.2}[along] else 0.02
    said = armodal("arm", "move", mine, first.id, "--by", ",".join(map(str, step)), "--json")
    assert said.returncode == 0, said.stderr
    moved = load_arm(mine).point(first.id)
    # The file keeps five decimals of a metre.
    np.testing.assert_allclose(moved.position_m, first.position_m + step, atol=2e-5)
    np.testing.assert_allclose(moved.R_link_sensor[:, 2], first.R_link_sensor[:, 2], atol=1e-5)
    assert json.loads(said.stdout)["moved_m"] == pytest.approx(0.02, abs=2e-5)


def test_a_point_is_found_by_three_distances(mine):
    points = points_of(load_arm(mine), "upper_arm")
    target, others = points[0], points[1:4]
    lines = mine.read_text()
    measured = ",".join(
        f"{one.id}:{np.linalg.norm(one.position_m - target.position_m):.4f}" for one in others
    )
    # The point is somewhere else in the file, and is measured where it was.
    armodal("arm", "move", mine, target.id, "--towards", f"{others[0].id}:0.01")
    assert mine.read_text() != lines
    said = armodal("arm", "move", mine, target.id, "--distances", measured)
    assert said.returncode == 0, said.stderr
    found = load_arm(mine).point(target.id).position_m
    # A tape read to 0.1 mm; three in a plane with the point tell its place in it as well as that.
    np.testing.assert_allclose(found, target.position_m, atol=5e-4)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "wanted one of --by, --towards and --distances"),
        (("--by", "0.4,0.4,0"), "mm off its surface"),
        (("--by", "1"), "--by: wanted 3 numbers"),
        (("--towards", "1"), "--towards: wanted POINT:METRES"),
        (("--towards", "24:0.1"), "wanted another point of link flange"),
        (("--distances", "2:0.01,3:0.01"), "--distances: wanted 3 of POINT:METRES, got 2"),
    ],
)
def test_a_move_that_cannot_be_meant_changes_nothing(options, words, mine):
    before = mine.read_text()
    refused(armodal("arm", "move", mine, "1", *options), words)
    assert mine.read_text() == before


def test_points_are_shown_here_and_on_a_page(made, tmp_path):
    arm = load_arm(made / "robot.toml")
    page = tmp_path / "points.html"
    posture = "--posture=0,30,-40,0,20,0"
    said = armodal("arm", "show", made / "robot.toml", "3", posture, "--html", page)
    assert said.returncode == 0, said.stderr
    assert all(f"•{point.id}" in said.stdout for point in points_of(arm, "upper_arm"))
    assert "Joints at 0, 30, -40, 0, 20, 0 degrees" in page.read_text()
    told = json.loads(armodal("arm", "show", made / "robot.toml", posture, "--json").stdout)
    q = np.deg2rad([0, 30, -40, 0, 20, 0])
    for point, row in zip(arm.points, told["points"], strict=True):
        T = link_pose(arm, point.link, q)
        np.testing.assert_allclose(row["place_m"], T[:3, :3] @ point.position_m + T[:3, 3])
        np.testing.assert_allclose(row["axes"][2], T[:3, :3] @ point.R_link_sensor[:, 2])
    refused(armodal("arm", "show", made / "robot.toml", "99"), "wanted points of the arm")
    refused(armodal("arm", "show", made / "robot.toml", "--html", page), "exists already")
