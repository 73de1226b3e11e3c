"""Masses filled by volume: from a total, from a density, and what is refused."""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest

from armodal.protocols.arm.files import ARMS_DIRECTORY, arm_from_texts, load_arm
from armodal.protocols.arm.rewrite import text_with_inertials
from armodal.protocols.errors import ArmError

HEAD = """format = "armodal-arm-1"
name = "by-volume"
source = "made for a test."
"""
LINKS = """
[[joints]]
name = "j1"
range_deg = [-170.0, 170.0]
dh = { alpha_deg = 0.0, a_m = 0.0, theta_offset_deg = 0.0, d_m = 0.335 }
link = { name = "one", volume_m3 = 0.003, center_m = [0.0, 0.0, 0.1], box_m = [0.1, 0.2, 0.3] }

[[joints]]
name = "j2"
range_deg = [-90.0, 45.0]
dh = { alpha_deg = -90.0, a_m = 0.075, theta_offset_deg = 90.0, d_m = 0.0 }
[joints.link]
name = "two"
volume_m3 = 0.001
center_m = [0.1, 0.0, 0.0]
inertia_over_mass_m2 = [0.01, 0.011, 0.012, 0.001, 0.0, 0.0]
"""
REST = """
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
sensor_tilt_deg = 0.5
sensor_gain = 0.01
hammer_gain = 0.01
hit_direction_deg = 1.0
"""
TOTAL = '[masses]\ntotal_kg = 28.0\nbase_volume_m3 = 0.004\nsource = "data sheet"\n'
DENSITY = '[masses]\ndensity_kg_m3 = 1810.0\nsource = "file 000"\n'


def arm_of(masses=TOTAL, links=LINKS):
    return arm_from_texts(HEAD + links + masses + REST, urdf_text=None, database_text=None)


def test_a_total_mass_is_shared_by_volume_with_the_base():
    one, two = (joint.link for joint in arm_of().joints)
    # 28 kg over 4 + 3 + 1 litres.
    assert one.mass_kg == pytest.approx(28 * 3 / 8)
    assert two.mass_kg == pytest.approx(28 * 1 / 8)


def test_a_total_without_the_base_is_the_sum_of_the_links():
    arm = arm_of(TOTAL.replace("0.004", "0.0"))
    assert sum(joint.link.mass_kg for joint in arm.joints) == pytest.approx(28.0)


def test_a_density_makes_volumes_masses():
    one, two = (joint.link for joint in arm_of(DENSITY).joints)
    assert one.mass_kg == pytest.approx(5.43)
    assert two.mass_kg == pytest.approx(1.81)


def test_a_box_and_an_inertia_over_mass_spread_it():
    one, two = (joint.link for joint in arm_of().joints)
    a, b, c = 0.1, 0.2, 0.3
    full = one.mass_kg / 12 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    np.testing.assert_allclose(one.inertia_kg_m2, full)
    over_mass = np.array([[0.01, 0.001, 0], [0.001, 0.011, 0], [0, 0, 0.012]])
    np.testing.assert_allclose(two.inertia_kg_m2, two.mass_kg * over_mass)


def test_what_was_filled_is_said_in_the_source():
    assert "28 kg shared by volume (data sheet)" in arm_of().source
    assert "volume times 1810 kg/m³ (file 000)" in arm_of(DENSITY).source


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("volume_m3 = 0.001\n", "", "joints[1].link: wanted mass_kg"),
        ("volume_m3 = 0.001", "volume_m3 = 0.0", "greater than 0"),
        ("volume_m3 = 0.001", "volume_m3 = 0.001\nmass_kg = 3.0", "not both"),
        ("box_m = [0.1, 0.2, 0.3]", "box_m = [0.1, 0.0, 0.3]", "greater than 0"),
        ("center_m = [0.0, 0.0, 0.1], ", "", "center_m with either box_m"),
        (", box_m = [0.1, 0.2, 0.3]", "", "center_m with either box_m"),
        ("[0.01, 0.011, 0.012,", "[0.01, 0.011, 0.052,", "no body has such an inertia"),
        (TOTAL, "", "joints[0].link.volume_m3: wanted a table [masses]"),
        ("total_kg = 28.0", "total_kg = 28.0\ndensity_kg_m3 = 1.0", "either total_kg or density"),
        ("total_kg = 28.0\n", "", "either total_kg or density"),
        ("base_volume_m3 = 0.004\n", "", "base_volume_m3 with total_kg"),
        ("total_kg = 28.0", "total_kg = -28.0", "greater than 0"),
        ('source = "data sheet"', "", "masses.source"),
    ],
)
def test_what_cannot_be_filled_is_refused(old, new, said):
    text = HEAD + LINKS + TOTAL + REST
    assert old in text
    with pytest.raises(ArmError) as caught:
        arm_from_texts(text.replace(old, new, 1), urdf_text=None, database_text=None)
    assert said in str(caught.value)


def test_a_link_with_a_mass_of_its_own_cannot_stand_among_filled_ones():
    own = "mass_kg = 2.0\ncenter_m = [0.1, 0.0, 0.0]\ninertia_kg_m2 = [0.02, 0.02, 0.02, 0, 0, 0]\n"
    links = LINKS[: LINKS.index("volume_m3 = 0.001")] + own
    with pytest.raises(ArmError, match=r"joints\[1\].link.volume_m3: wanted a volume for every"):
        arm_of(links=links)


@pytest.fixture
def urdf_arm(tmp_path):
    """The shipped URDF arm with its masses filled by volume, the URDF's own shapes kept."""
    for name in ("rv4frl.toml", "rv4frl.urdf"):
        shutil.copy(ARMS_DIRECTORY / name, tmp_path / name)
    path = tmp_path / "rv4frl.toml"
    shipped = load_arm("rv4frl")
    text = path.read_text(encoding="utf-8")
    for joint in shipped.joints:
        volume = joint.link.mass_kg / 1810.0
        link = f'link = {{ name = "{joint.link.name}", volume_m3 = {volume!r} }}\n'
        name = f'name = "{joint.name}"\n'
        text = text.replace(name, name + link, 1)
    path.write_text(text.replace("[[points]]", DENSITY.replace("1810", "905") + "[[points]]", 1))
    return path, shipped


def test_a_urdfs_inertias_follow_the_filled_mass(urdf_arm):
    path, shipped = urdf_arm
    for joint, whole in zip(load_arm(path).joints, shipped.joints, strict=True):
        assert joint.link.mass_kg == pytest.approx(whole.link.mass_kg / 2)
        np.testing.assert_allclose(joint.link.inertia_kg_m2, whole.link.inertia_kg_m2 / 2)
        np.testing.assert_array_equal(joint.link.center_m, whole.link.center_m)


def test_a_urdf_without_an_inertial_is_refused_unless_the_arm_file_gives_it(urdf_arm):
    path, shipped = urdf_arm
    name = shipped.joints[3].link.name
    urdf = path.with_name("rv4frl.urdf")
    text = urdf.read_text(encoding="utf-8")
    start = text.index("<inertial>", text.index(f'<link name="{name}"'))
    end = text.index("</inertial>", start) + len("</inertial>")
    urdf.write_text(text[:start] + text[end:])
    with pytest.raises(ArmError, match=f"link {name}: wanted an inertial"):
        load_arm(path)
    arm_text = path.read_text(encoding="utf-8")
    spread = ", center_m = [0.0, 0.0, 0.0], box_m = [0.1, 0.1, 0.2] }"
    path.write_text(
        re.sub(rf'(name = "{name}", volume_m3 = [0-9.e-]+) }}', rf"\1{spread}", arm_text)
    )
    assert load_arm(path).joints[3].link.mass_kg > 0


def test_calibrated_links_no_longer_need_the_volumes():
    arm = arm_of()
    text = text_with_inertials(
        arm.text, [joint.link for joint in arm.joints], name="given", source="test"
    )
    again = arm_from_texts(text, urdf_text=None, database_text=None)
    for joint, before in zip(again.joints, arm.joints, strict=True):
        assert joint.link.mass_kg == pytest.approx(before.link.mass_kg, rel=1e-5)  # six digits


def test_a_joint_that_mimics_another_is_refused_by_name(tmp_path):
    for name in ("rv4frl.toml", "rv4frl.urdf"):
        shutil.copy(ARMS_DIRECTORY / name, tmp_path / name)
    urdf = tmp_path / "rv4frl.urdf"
    text = urdf.read_text(encoding="utf-8")
    at = text.index("<axis", text.index('<joint name="joint_3"'))
    urdf.write_text(text[:at] + '<mimic joint="joint_2"/>' + text[at:])
    with pytest.raises(ArmError, match="joint joint_3: wanted a joint that moves by itself"):
        load_arm(tmp_path / "rv4frl.toml")
