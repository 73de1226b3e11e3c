"""A corrected arm in MuJoCo, by itself and in a user's MJCF: the arm file's frequencies."""

import re
from dataclasses import replace

import pytest
from support.added import added, any_of, axis, with_effects
from support.own_mjcf import own_mjcf
from support.quick import few_quick

from armodal.analyzer.export import losses
from armodal.analyzer.export.by_mujoco import compare_frequencies
from armodal.analyzer.export.exported import ready_for_export
from armodal.analyzer.export.mjcf import mjcf_text
from armodal.analyzer.export.mjcf_patch import patched_mjcf
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

mujoco = pytest.importorskip("mujoco")

pytestmark = pytest.mark.usefixtures("not_apart")

UR5 = load_arm("ur5")

# What MuJoCo's slopes by differences of 1e-6 leave of a mode.
EXACT = 1e-6
# Gravity on a base of its own and on links in pieces, which the arm's equations leave out.
WITH_WEIGHT = 2e-3
KINDS = {
    "bearing": EXACT,
    "coupling": EXACT,
    "payload": EXACT,
    "released_joint": EXACT,
    "rotor": EXACT,
    "servo": EXACT,
    "encoder_offset": EXACT,
    "base": WITH_WEIGHT,
    "link_bending": WITH_WEIGHT,
    "link_torsion": WITH_WEIGHT,
}


@pytest.fixture
def few_postures(monkeypatch):
    """Losses as dampers are judged in few postures: no natural frequency depends on it."""
    monkeypatch.setattr(losses, "_POSTURES", 2)


def compared(arm, text=None, n_postures=3):
    ready = ready_for_export(arm)
    model = mujoco.MjModel.from_xml_string(text or mjcf_text(arm, ready.tree))
    return compare_frequencies(
        ready.correction, ready.tree, mujoco, model, n_postures=n_postures, below_hz=500.0
    )


@pytest.mark.usefixtures("few_postures")
@pytest.mark.parametrize("kind", few_quick(KINDS, "bearing", "servo", "base", "link_torsion"))
def test_mujoco_has_the_frequencies_of_the_arm_file(kind):
    found = compared(with_effects(UR5, any_of(UR5, kind)))
    assert found.largest < KINDS[kind]
    assert found.n_modes >= 5


@pytest.mark.usefixtures("few_postures")
def test_all_at_once_on_one_arm():
    several = [any_of(UR5, kind) for kind in KINDS]
    found = compared(with_effects(UR5, axis("forearm"), *several), n_postures=2)
    assert found.largest < WITH_WEIGHT


@pytest.mark.usefixtures("few_postures")
def test_wrist_gears_are_a_tendon():
    arm = load_arm("viper_s650")
    found = compared(
        with_effects(arm, any_of(arm, "wrist_coupling"), axis(arm.joints[1].link.name))
    )
    assert found.largest < EXACT


def test_loss_factors_are_dampers_and_how_far_off_is_said():
    more = {f"loss_{joint.name}": 0.04 for joint in UR5.joints if joint.stiffness is not None}
    ready = ready_for_export(with_effects(UR5, added("hysteretic", "whole arm", **more)))
    (note,) = ready.notes
    said = re.search(r"at most ([\d.]+) %, damping ratios by ([\d.]+) points", note)
    assert said is not None
    # A damper set at f0 takes half the loss factor times f / f0: to 200 Hz some times too much.
    assert 0.0 < float(said[1]) < 10.0
    assert 0.0 < float(said[2]) < 100.0 * 0.02 * 200.0 / 30.0


def test_what_changes_with_the_posture_has_no_counterpart():
    with pytest.raises(ArmError, match="wanted effects that are the same in every posture"):
        ready_for_export(with_effects(UR5, any_of(UR5, "load_damping")))


# --- a user's own file: other frames, names, a mesh-free picture, an actuator and a comment.


def patched(arm, text, tmp_path):
    source = tmp_path / "mine.xml"
    source.write_text(text, encoding="utf-8")
    tree = ready_for_export(arm).tree
    return patched_mjcf(arm, tree, source, tmp_path / "out.xml", mujoco)


@pytest.mark.usefixtures("few_postures")
def test_a_user_s_mjcf_is_patched_and_everything_of_its_own_stays(tmp_path):
    kinds = ("bearing", "base", "servo", "coupling", "link_torsion")
    arm = with_effects(UR5, axis("forearm"), *(any_of(UR5, kind) for kind in kinds))
    text, notes = patched(arm, own_mjcf(arm), tmp_path)
    assert compared(arm, text).largest < WITH_WEIGHT
    assert "<!-- kept -->" in text
    model = mujoco.MjModel.from_xml_string(text)
    assert model.actuator("drive").id == 0
    assert model.geom("skin forearm").id >= 0
    assert model.body("stand").pos == pytest.approx([0.3, 0.0, 0.2])
    assert "those of the arm file" in notes[0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace('"elbow"', '"other"', 1), "wanted the joints elbow"),
        (
            lambda t: t.replace(
                "</mujoco>",
                '<equality><weld name="loop" body1="forearm" body2="stand"/></equality></mujoco>',
            ),
            "loops closed by loop",
        ),
        (lambda t: t.replace("<mujoco", "<robot").replace("</mujoco", "</robot"), "got <robot>"),
        (lambda t: t[:-20], "wanted XML"),
        (lambda t: t.replace('axis="', 'axis="0.5 '), "does not; open it"),
    ],
)
def test_a_file_that_is_not_this_open_arm_is_refused(change, message, tmp_path):
    arm = with_effects(UR5, axis("forearm"))
    with pytest.raises(ArmError, match=re.escape(message)):
        patched(arm, change(own_mjcf(arm)), tmp_path)


def test_joints_without_names_and_in_another_place_are_refused(tmp_path):
    unnamed = own_mjcf(UR5, names=False).replace('<motor name="drive" joint=""/>', "")
    with pytest.raises(ArmError, match="6 without a name"):
        patched(UR5, unnamed, tmp_path)
    first = UR5.joints[0]
    T = first.T_parent_joint.copy()
    T[2, 3] += 0.05
    second = UR5.joints[1]
    moved = second.T_parent_joint.copy()
    moved[0, 3] += 0.05
    joints = (first, replace(second, T_parent_joint=moved), *UR5.joints[2:])
    with pytest.raises(ArmError, match="wanted an MJCF whose joints lie as those of arm"):
        patched(UR5, own_mjcf(replace(UR5, joints=joints)), tmp_path)


def test_joints_in_another_order_are_refused(tmp_path):
    with pytest.raises(ArmError, match="wanted the joints in the order"):
        patched(UR5, own_mjcf(UR5, order=(1, 0, 2, 3, 4, 5)), tmp_path)


def test_a_second_patch_is_refused(tmp_path):
    arm = with_effects(UR5, axis("forearm"))
    text, _ = patched(arm, own_mjcf(arm), tmp_path)
    with pytest.raises(ArmError, match="the model as it was before the corrections"):
        patched(arm, text, tmp_path)
