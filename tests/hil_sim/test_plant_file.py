from pathlib import Path

import numpy as np
import pytest

import armodal.hil_sim.plant
from armodal.hil_sim.plant import load_plant
from armodal.hil_sim.small_motion import linearise
from armodal.protocols.errors import PlantError

SHIPPED = Path(armodal.hil_sim.plant.__file__).parent / "plants" / "rv4frl.toml"


def changed(tmp_path, old, new):
    """The shipped file with the first occurrence of a text replaced."""
    text = SHIPPED.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "changed.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_links_are_those_of_the_shipped_arm(plant, arm):
    # Both files hold the same decimals; the arm's pass through rotations by zero.
    exact = 1e-15
    assert [link.joint for link in plant.truth.links] == [joint.name for joint in arm.joints]
    assert plant.truth.gravity_m_s2 == pytest.approx(arm.gravity_m_s2, abs=exact)
    for link, joint in zip(plant.truth.links, arm.joints, strict=True):
        assert link.name == joint.link.name
        assert joint.T_parent_joint[:3, :3] == pytest.approx(np.eye(3), abs=exact)
        assert link.origin_m == pytest.approx(joint.T_parent_joint[:3, 3], abs=exact)
        assert link.axis == pytest.approx(joint.axis, abs=exact)
        assert link.mass_kg == pytest.approx(joint.link.mass_kg, rel=exact)
        assert link.center_m == pytest.approx(joint.link.center_m, abs=exact)
        assert link.inertia_matrix() == pytest.approx(joint.link.inertia_kg_m2, abs=exact)
        # The URDF prints radians to six digits.
        assert np.deg2rad(link.range_deg) == pytest.approx(joint.range_rad, abs=1e-5)


def test_points_are_those_of_the_shipped_arm(plant, arm):
    assert list(plant.points) == [point.id for point in arm.points]
    for point in arm.points:
        own = plant.points[point.id]
        assert own.link == point.link
        assert own.position_m == pytest.approx(point.position_m, abs=1e-15)
        # Unit vectors written with few digits, normed in one file and taken as read in the other.
        assert own.R_link_sensor == pytest.approx(point.R_link_sensor, abs=1e-6)


def test_the_same_joints_give_way_as_in_the_shipped_arm(plant, arm):
    soft = [link.joint for link in plant.truth.links if link.stiffness_n_m_per_rad is not None]
    assert soft == [joint.name for joint in arm.joints if joint.stiffness is not None]


def test_the_hidden_axis_rules_a_mode_between_75_and_83_hz(plant):
    motion = linearise(plant, np.deg2rad([-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]), None)
    n = len(plant.springs)
    hidden = plant.springs.index(plant.hidden)
    oscillating = motion.poles.imag > 0.0
    strain = plant.stiffness[:, None] * np.abs(motion.modes[:n, oscillating]) ** 2
    share = strain[hidden] / strain.sum(axis=0)
    ruled = np.abs(motion.poles[oscillating][np.argmax(share)]) / (2.0 * np.pi)
    assert share.max() > 0.5
    assert 75.0 < ruled < 83.0


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("mass_kg = 6.53", "mass_kg = -6.53", "links.0.mass_kg"),
        ("mass_kg = 6.53", "mass_kg = nan", "links.0.mass_kg"),
        ("mass_kg = 6.53", 'mass_kg = "6.53"', "links.0.mass_kg"),
        ("mass_kg = 6.53", "mass_kg = 6.53\ncolour = 1", "links.0.colour"),
        ('name = "rv4frl"', 'name = "rv4frl"\ncolour = 1', "colour"),
        ("damping_n_m_s_per_rad = 15.2", "", "links.0"),
        ("axis = [0.0, 0.0, 1.0]", "axis = [0.0, 0.0, 2.0]", "links.0"),
        ("[0.067532, ", "[0.67532, ", "links.0"),
        ("range_v = 5.0", "range_v = 0.0", "board.range_v"),
        ("direction = [1.0, 0.0, 0.29]", "direction = [0.0, 0.0, 0.0]", "hidden_axis"),
        ('link = "base"', 'link = "table"', "points"),
        ('id = "2"', 'id = "1"', "points"),
        ("double_probability = 0.04", "double_probability = 0.99", "hand"),
    ],
)
def test_an_impossible_value_is_refused_by_its_key(tmp_path, old, new, key):
    with pytest.raises(PlantError, match=key.replace(".", r"\.")):
        load_plant(changed(tmp_path, old, new))


def test_a_file_that_is_missing_or_no_toml_is_refused(tmp_path):
    with pytest.raises(PlantError, match="found none"):
        load_plant(tmp_path / "nothing.toml")
    with pytest.raises(PlantError, match="wanted valid TOML"):
        load_plant(changed(tmp_path, "name = ", "name "))


def test_a_posture_of_wrong_length_and_an_unknown_point_are_refused(plant):
    with pytest.raises(PlantError, match="6 finite joint angles"):
        plant.hinge_angles([0.0, 1.0])
    with pytest.raises(PlantError, match="no test point '99'"):
        plant.point("99")
