from __future__ import annotations

import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.examples import examples

from armodal.protocols.arm.files import ARMS_DIRECTORY, arm_from_texts, load_arm, shipped_arms
from armodal.protocols.errors import ArmError

TEXT = (ARMS_DIRECTORY / "rv4frl.toml").read_text(encoding="utf-8")
EXAMPLE = ARMS_DIRECTORY / "examples" / "rv4frl-cia402.toml"

# Published results of the test (paper 000, Table 4, with c2 as its own Eq. (2) gives it).
PUBLISHED_K = {"joint_1": 20789.0, "joint_2": 24307.0, "joint_3": 21243.0}
PUBLISHED_C = {"joint_1": 15.2, "joint_2": 8.46, "joint_3": 5.9}

DH_ARM = """
format = "armodal-arm-1"
name = "two-rows"
source = "made for a test"

[[joints]]
name = "j1"
range_deg = [-170.0, 170.0]
stiffness_n_m_per_rad = { value = 1e4, std = 4e3, source = "guess" }
damping_n_m_s_per_rad = { value = 5.0, std = 2.0, source = "guess" }
dh = { alpha_deg = 0.0, a_m = 0.0, theta_offset_deg = 0.0, d_m = 0.335 }
[joints.link]
name = "one"
mass_kg = 5.0
center_m = [0.0, 0.0, 0.1]
inertia_kg_m2 = [0.02, 0.03, 0.04, 0.001, 0.002, 0.003]

[[joints]]
name = "j2"
range_deg = [-90.0, 45.0]
dh = { alpha_deg = -90.0, a_m = 0.075, theta_offset_deg = 90.0, d_m = 0.0 }
[joints.link]
name = "two"
mass_kg = 2.0
center_m = [0.1, 0.0, 0.0]
inertia_kg_m2 = [0.02, 0.02, 0.02, 0.0, 0.0, 0.0]

[[points]]
id = "1"
link = "two"
position_m = [0.2, 0.0, 0.05]
normal = [0.0, 0.0, 1.0]
x_axis = [1.0, 0.0, 0.0]

[tolerances]
mass = 0.05
inertia = 0.06
center_m = 0.003
encoder_offset_deg = 0.15
sensor_tilt_deg = 0.9
sensor_gain = 0.011
hammer_gain = 0.02
hit_direction_deg = 1.4
"""


def test_tolerances_that_are_left_out_are_the_usual_ones(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(DH_ARM[: DH_ARM.index("[tolerances]")], encoding="utf-8")
    assert load_arm(path).tolerances == load_arm("rv4frl").tolerances
    (said,) = load_arm(path).tolerances.remarks
    assert "no tolerance of mass, inertia, center_m, encoder_offset_deg" in said
    assert load_arm("rv4frl").tolerances.remarks == ()
    path.write_text("tolerances = { mass = 0.2 }\n" + path.read_text(), encoding="utf-8")
    assert load_arm(path).tolerances == replace(load_arm("rv4frl").tolerances, mass=0.2)
    (said,) = load_arm(path).tolerances.remarks
    assert "no tolerance of inertia" in said


def message_after(tmp_path: Path, old: str, new: str, text: str = TEXT) -> str:
    """Refusal of the arm file with the first `old` replaced."""
    assert old in text
    path = tmp_path / "a.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ArmError) as caught:
        load_arm(path)
    return str(caught.value)


def test_the_shipped_arm_has_the_points_of_the_paper() -> None:
    arm = load_arm("rv4frl")
    assert [point.id for point in arm.points] == [str(n) for n in range(1, 19)]
    assert arm.point("1").link == "hand_flange"
    assert arm.groups["points 1-14"] == tuple(str(n) for n in range(1, 15))
    assert arm.groups["points 15-18"] == ("15", "16", "17", "18")
    assert {arm.point(n).link for n in ("17", "18")} == {"base"}
    with pytest.raises(KeyError):
        arm.point("19")


def test_first_guesses_are_off_by_20_to_50_percent_and_say_so() -> None:
    for joint in load_arm("rv4frl").joints[:3]:
        for estimate, published in (
            (joint.stiffness, PUBLISHED_K[joint.name]),
            (joint.damping, PUBLISHED_C[joint.name]),
        ):
            assert estimate is not None
            error = abs(estimate.value / published - 1.0)
            assert 0.2 <= error <= 0.5
            assert abs(estimate.value - published) < 2.0 * estimate.std
            assert estimate.source == "first guess before any test"


def test_joints_without_stiffness_are_rigid() -> None:
    joints = load_arm("rv4frl").joints
    assert [joint.stiffness is None for joint in joints] == [False] * 3 + [True] * 3
    assert [joint.damping is None for joint in joints] == [False] * 3 + [True] * 3


def test_sensor_frames_are_rotations_with_z_along_the_outward_normal() -> None:
    arm = load_arm("rv4frl")
    centers = {joint.link.name: joint.link.center_m for joint in arm.joints}
    for point in arm.points:
        R = point.R_link_sensor
        # Orthonormalised in float64.
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
        assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-14)
        # Outward: away from the link's centre of mass (the base has none).
        if point.link in centers:
            assert R[:, 2] @ (point.position_m - centers[point.link]) > 0.0


@pytest.mark.parametrize("links", [("wrist", "hand_flange"), ("forearm", "elbow"), ("upper_arm",)])
def test_points_on_what_moves_together_span_all_directions(links: tuple[str, ...]) -> None:
    arm = load_arm("rv4frl")
    for link in links[:1]:
        positions = np.array([p.position_m for p in arm.points if p.link == link])
        assert len(positions) >= 3
        spread = np.linalg.svd(positions - positions.mean(axis=0), compute_uv=False)
        # Three points span a plane, four a volume; collinear ones would leave the second at zero.
        assert spread[1] > 0.03


def test_an_arm_is_rebuilt_from_the_texts_it_carries() -> None:
    for source in ("rv4frl", EXAMPLE):
        arm = load_arm(source)
        assert arm.can is not None
        again = arm_from_texts(
            arm.text, urdf_text=arm.urdf_text, database_text=arm.can.database_text
        )
        assert again.sha256 == arm.sha256
        assert again.can == arm.can
        assert [p.id for p in again.points] == [p.id for p in arm.points]


def test_the_digest_covers_every_text(tmp_path: Path) -> None:
    digests = {load_arm("rv4frl").sha256}
    for name in ("rv4frl.toml", "rv4frl.urdf", "armodal_controller.dbc"):
        folder = tmp_path / name
        folder.mkdir()
        shutil.copy(ARMS_DIRECTORY / "rv4frl.toml", folder)
        shutil.copy(ARMS_DIRECTORY / "rv4frl.urdf", folder)
        shutil.copy(ARMS_DIRECTORY.parent.parent / "dbc" / "armodal_controller.dbc", folder)
        comment = {"toml": "\n# x\n", "urdf": "\n<!-- x -->\n", "dbc": "\n"}
        path = folder / name
        path.write_text(path.read_text() + comment[name.rsplit(".", 1)[1]])
        digests.add(load_arm(folder / "rv4frl.toml").sha256)
    assert len(digests) == 4


def test_a_file_beside_the_arm_file_comes_before_the_shipped_one(tmp_path: Path) -> None:
    shutil.copy(ARMS_DIRECTORY / "rv4frl.toml", tmp_path)
    urdf = (ARMS_DIRECTORY / "rv4frl.urdf").read_text(encoding="utf-8")
    (tmp_path / "rv4frl.urdf").write_text(urdf.replace('"6.5300"', '"7.5"'))
    assert load_arm(tmp_path / "rv4frl.toml").joints[0].link.mass_kg == 7.5


def test_dh_rows_serve_in_place_of_a_urdf() -> None:
    arm = arm_from_texts(DH_ARM, urdf_text=None, database_text=None)
    assert arm.urdf_text is None
    assert arm.can is None
    one, two = arm.joints
    assert one.link.inertia_kg_m2.tolist() == [
        [0.02, 0.001, 0.002],
        [0.001, 0.03, 0.003],
        [0.002, 0.003, 0.04],
    ]
    assert two.range_rad == (math.radians(-90.0), math.radians(45.0))
    # RotX(-90) then RotZ(90): x of frame 2 is minus z of frame 1, z is y.
    expected = [[0, -1, 0, 0.075], [0, 0, 1, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]
    np.testing.assert_allclose(two.T_parent_joint, expected, atol=1e-15)


K1 = "stiffness_n_m_per_rad = { value = 14000.0, std = 5600.0"
NAMES = "joint_1, joint_2, joint_3, joint_4, joint_5, joint_6"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("armodal-arm-1", "armodal-arm-2", "format: wanted 'armodal-arm-1', got 'armodal-arm-2'"),
        ('name = "rv4frl"', 'name = "../x"', "name: wanted"),
        (K1, K1.replace("14000.0", "-1.0"),
         ("joints[0].stiffness_n_m_per_rad.value: wanted greater than 0, got -1.0; "
         "joints[0] is 'joint_1'")),
        (K1, K1.replace("5600.0", "0.0"),
         "joints[0].stiffness_n_m_per_rad.std: wanted greater than 0, got 0.0"),
        (K1, K1.replace("14000.0", "nan"),
         "joints[0].stiffness_n_m_per_rad.value: wanted a finite number, got nan"),
        (K1, "stiffness_n_m_per_rad = 14000.0 #",
         "joints[0].stiffness_n_m_per_rad: wanted a table, got 14000.0"),
        ("stiffness_n_m_per_rad", "stiffness_nm_per_rad",
         "joints[0].stiffness_nm_per_rad: wanted one of the keys"),
        (K1, "# " + K1, "joints[0]: wanted stiffness_n_m_per_rad and damping_n_m_s_per_rad"),
        ('name = "joint_6"', 'name = "joint_7"',
         f"joints: wanted the URDF's joints from the base outwards, {NAMES}, got"),
        ('name = "joint_6"', 'name = "joint_6"\nrange_deg = [-400.0, 10.0]',
         "joints[5].range_deg: wanted within the URDF's -360.00 to 360.00, got [-400.0, 10.0]"),
        ('name = "joint_6"', 'name = "joint_6"\nrange_deg = [10.0, 10.0]',
         "joints[5].range_deg: wanted lower before upper"),
        ('name = "joint_6"',
         'name = "joint_6"\ndh = { alpha_deg = 0.0, a_m = 0.0, theta_offset_deg = 0.0, d_m = 0.0 }',
         "joints[5].dh: wanted it left to the URDF"),
        ('urdf = "rv4frl.urdf"', 'urdf = "../rv4frl.urdf"', "urdf: wanted"),
        ('urdf = "rv4frl.urdf"', 'urdf = "/etc/passwd"', "urdf: wanted"),
        ('urdf = "rv4frl.urdf"', 'urdf = ".."', "urdf: wanted"),
        ('urdf = "rv4frl.urdf"', 'urdf = "a\\\\b.urdf"', "urdf: wanted"),
        ('urdf = "rv4frl.urdf"', 'urdf = "absent.urdf"',
         "urdf: wanted the name of a file beside the arm file, or of a shipped one"),
        ('urdf = "rv4frl.urdf"', "", "joints[0].dh: wanted a value, since the file names no URDF"),
        ("gravity_m_s2 = [0.0,", "gravity_m_s2 = [", "gravity_m_s2: wanted at least 3 items"),
        ('link = "hand_flange"', 'link = "hand"',
         ("points[0].link: wanted one of the links base, shoulder, upper_arm, elbow, forearm, "
         "wrist, hand_flange, got 'hand'")),
        ("normal = [0.0, 0.8, 0.6]", "normal = [0.0, 0.8, 0.7]",
         "points[0].normal: wanted a vector of length 1 (this one has 1.063)"),
        ("normal = [0.0, 0.8, 0.6]", "normal = [0.6, 0.0, 0.8]",
         "points[0]: wanted x_axis perpendicular to normal (the angle is 53.13 degrees)"),
        ("[0.000, 0.025, 0.012]", "[0.000, 0.025, 1e9]", "points[0].position_m[2]: wanted"),
        ('id = "2"', 'id = "1"', "points[1].id: wanted an id of its own, got '1'"),
        ('id = "2"', 'id = "a b"', "points[1].id: wanted"),
        ('base = ["17", "18"]', 'base = ["17", "19"]',
         "groups.base[1]: wanted the id of a point, once, got '19'"),
        ('base = ["17", "18"]', 'base = ["17", "17"]', "groups.base[1]: wanted the id of a point"),
        ('base = ["17", "18"]', "base = []", "groups.base: wanted at least 1 items, got []"),
        ("mass = 0.05", "mass = -0.05", "tolerances.mass: wanted greater than 0, got -0.05"),
        ("hammer_gain", "hammer_gian",
         ("tolerances.hammer_gian: wanted one of the keys mass, inertia, center_m, "
         "encoder_offset_deg, sensor_tilt_deg, sensor_gain, hammer_gain, hit_direction_deg, "
         "moving_mass, got the unknown key 'hammer_gian' (did you mean hammer_gain?)")),
        ("armodal_controller.dbc", "absent.dbc", "can.database: wanted the name of a file"),
        ("armodal_controller.dbc", "../dbc/cia402.dbc", "can.database: wanted"),
        ("armodal_controller.dbc", "cia402.dbc",
         "can.joints[0]: wanted a message of the database (TPDO1_NODE_1,"),
        ('signal = "POSITION_3"', 'signal = "POSITION_1"',
         ("can.joints[2]: wanted a signal of JOINTS_3_4 (POSITION_3, POSITION_4, DRIVE_STATE, "
         "COUNTER), got 'POSITION_1'")),
        ('{ joint = "joint_3"', '{ joint = "joint_2"',
         f"can.joints[2].joint: wanted each of {NAMES} once, got 'joint_2'"),
        ('    { joint = "joint_3"', '    # { joint = "joint_3"',
         "can.joints: wanted a signal for every joint, got ['joint_3']"),
        ("sign = 1", "sign = 0", "can.joints[0].sign: wanted -1 or 1, got 0; can.joints[0] is"),
        ("scale_deg = 1.0", "scale_deg = 0.0", "can.joints[0].scale_deg: wanted greater than 0"),
        ("scale_deg = 1.0", "gear_ratio = 100.0",
         "can.joints[0]: wanted either scale_deg, or counts_per_revolution and gear_ratio"),
        ("scale_deg = 1.0", "scale_deg = 1.0, gear_ratio = 2.0, counts_per_revolution = 2.0",
         "can.joints[0]: wanted either scale_deg, or counts_per_revolution and gear_ratio"),
        ('signal = "DRIVE_STATE"', 'signal = "STATE"', "can.drive_state: wanted a signal of"),
        ('signal = "DRIVE_STATE"', 'signal = "POSITION_1"',
         "can.drive_state: wanted JOINTS_1_2.POSITION_1 unsigned and unscaled"),
        ('signal = "COUNTER"', 'signal = "POSITION_1"',
         "can.counter: wanted JOINTS_1_2.POSITION_1 unsigned and unscaled"),
        ("stale_after_s = 0.5", "stale_after_s = 0.001", "can: wanted stale_after_s of at least"),
        ("bitrate = 500000", "bitrate = 500000.0", "can.bitrate: wanted an integer, got 500000.0"),
    ],
)  # fmt: skip
def test_each_fault_is_refused_with_its_path(tmp_path: Path, old: str, new: str, said: str) -> None:
    message = message_after(tmp_path, old, new)
    assert message.startswith(f"arm file a.toml: {said}"), message


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("mass_kg = 5.0", "mass_kg = -5.0",
         "joints[0].link.mass_kg: wanted greater than 0, got -5.0; joints[0] is 'j1'"),
        ("[0.02, 0.03, 0.04,", "[0.02, 0.03, 0.09,",
         "joints[0].link: link one: wanted principal moments of which none exceeds"),
        ("[0.02, 0.03, 0.04,", "[-0.02, 0.03, 0.04,",
         "joints[0].link: link one: wanted a positive definite inertia"),
        ("range_deg = [-90.0, 45.0]", "", "joints[1].range_deg: wanted a value, since"),
        ('name = "j2"', 'name = "j1"', "joints: wanted joint names that differ"),
        ('name = "two"', 'name = "one"', "joints: wanted link names that differ, got 'one'"),
        ('name = "two"', 'name = "base"', "joints: wanted link names that differ, got 'base'"),
        ("a_m = 0.075", "a_m = inf", "joints[1].dh.a_m: wanted"),
    ],
)  # fmt: skip
def test_each_fault_of_dh_rows_is_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    message = message_after(tmp_path, old, new, DH_ARM)
    assert message.startswith(f"arm file a.toml: {said}"), message


def test_a_urdf_fault_names_the_link(tmp_path: Path) -> None:
    shutil.copy(ARMS_DIRECTORY / "rv4frl.toml", tmp_path)
    urdf = (ARMS_DIRECTORY / "rv4frl.urdf").read_text(encoding="utf-8")
    (tmp_path / "rv4frl.urdf").write_text(urdf.replace('"4.8924"', '"-4.8924"'))
    with pytest.raises(
        ArmError, match=r"urdf rv4frl\.urdf: link forearm: wanted a mass above 0 kg, got -4.8924"
    ):
        load_arm(tmp_path / "rv4frl.toml")


def test_an_unknown_shipped_arm_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ArmError, match="wanted a path to an arm file or one of the shipped arms"):
        load_arm("rv5")
    assert "rv4frl" in shipped_arms()


def test_an_absent_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ArmError, match="wanted a readable file, found none"):
        load_arm(tmp_path / "a.toml")


def test_texts_that_the_file_names_must_be_given() -> None:
    with pytest.raises(ArmError, match="urdf: wanted the text"):
        arm_from_texts(TEXT, urdf_text=None, database_text=None)
    urdf = (ARMS_DIRECTORY / "rv4frl.urdf").read_text(encoding="utf-8")
    with pytest.raises(ArmError, match=r"can\.database: wanted the database's text"):
        arm_from_texts(TEXT, urdf_text=urdf, database_text=None)


values = st.one_of(
    st.floats(),
    st.integers(-(2**63), 2**63),
    st.booleans(),
    st.just("text"),
    st.just([]),
    st.just([1.0, "x"]),
)


def as_toml(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"text"'
    if isinstance(value, list):
        return "[" + ", ".join(as_toml(item) for item in value) + "]"
    return repr(value)


@settings(max_examples=examples(150))
@given(st.data())
def test_any_value_in_any_place_is_read_or_refused(data: st.DataObject) -> None:
    lines = DH_ARM.splitlines()
    places = [n for n, line in enumerate(lines) if " = " in line]
    place = data.draw(st.sampled_from(places))
    key = lines[place].split(" = ", 1)[0]
    lines[place] = f"{key} = {as_toml(data.draw(values))}"
    try:
        arm = arm_from_texts("\n".join(lines), urdf_text=None, database_text=None)
    except ArmError as error:
        told = str(error)
    else:
        told = f"arm file: {arm.name}"
    assert told.startswith("arm file: ")


def test_keep_outs_are_boxes_and_one_inside_out_is_refused():
    text = (ARMS_DIRECTORY / "ur5.toml").read_text(encoding="utf-8")
    box = '\n[[keep_outs]]\nname = "post"\nlow_m = [0.1, 0.2, 0.3]\nhigh_m = [0.4, 0.5, {}]\n'
    kept = arm_from_texts(text + box.format("0.6"), urdf_text=None, database_text=None).keep_outs
    assert [(one.name, one.low_m.tolist(), one.high_m.tolist()) for one in kept] == [
        ("post", [0.1, 0.2, 0.3], [0.4, 0.5, 0.6])
    ]
    with pytest.raises(ArmError, match=r"keep_outs\[0\]: wanted low_m below high_m"):
        arm_from_texts(text + box.format("0.2"), urdf_text=None, database_text=None)
