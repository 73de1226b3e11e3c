"""A corrected arm as URDF, back through pinocchio; as SDF, back by its own poses."""

from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin
import pytest
import scipy.linalg
from scipy.spatial.transform import Rotation
from support.added import any_of, axis, with_effects
from support.sdf_rules import faults

from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.analyzer.export.exported import ready_for_export
from armodal.analyzer.export.sdf import sdf_text
from armodal.analyzer.export.urdf import patched_urdf, urdf_text
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.urdf import parse_xml
from armodal.protocols.errors import ArmError

RV = load_arm("rv4frl")
Q = np.array([0.3, 0.4, 1.1, -0.5, 0.6, 0.2])
# Rounding, and the milligrams of links between joints of one place.
SAME = 1e-6
KINDS = ("bearing", "payload", "released_joint", "link_torsion")


def pinocchio_frequencies(text, arm, elastic, springs):
    model = pin.buildModelFromXML(text)
    model.gravity = pin.Motion(np.asarray(arm.gravity_m_s2), np.zeros(3))
    q = pin.neutral(model)
    for joint, angle in zip(arm.joints, Q, strict=True):
        own = model.joints[model.getJointId(joint.name)]
        q[own.idx_q] = angle
    data = model.createData()
    mass = pin.crba(model, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    weight = pin.computeGeneralizedGravityDerivatives(model, data, q)
    at = [model.joints[model.getJointId(name)].idx_v for name in elastic]
    i = np.ix_(at, at)
    K = (weight[i] + weight[i].T) / 2.0 + np.diag([springs[name] for name in elastic])
    return np.sqrt(scipy.linalg.eigvalsh(K, mass[i])) / (2.0 * np.pi)


def own_frequencies(ready):
    own = corrected_posture(ready.correction, stand(ready.correction, Q))
    return np.sqrt(scipy.linalg.eigvalsh(own.stiffness, own.mass)) / (2.0 * np.pi)


def springs_of(text):
    return {
        own.get("reference"): float(own.findtext("springStiffness"))
        for own in parse_xml(text).iter("gazebo")
    }


@pytest.mark.parametrize("kind", [*KINDS, "axis"])
def test_pinocchio_has_the_frequencies_of_the_arm_file(kind):
    arm = with_effects(RV, axis("elbow") if kind == "axis" else any_of(RV, kind))
    ready = ready_for_export(arm)
    for text, notes in (urdf_text(arm, ready.tree), patched_urdf(arm, ready.tree, None)):
        found = pinocchio_frequencies(text, arm, ready.tree.elastic, springs_of(text))
        # Gravity does not follow the pieces of a twisting link in the arm's own equations.
        rel = 2e-3 if kind == "link_torsion" else SAME
        assert found == pytest.approx(own_frequencies(ready), rel=rel)
        assert "URDF has no springs" in notes[0]


def test_a_base_is_put_under_the_user_s_own_root():
    ready = ready_for_export(with_effects(RV, any_of(RV, "base")))
    text, _ = patched_urdf(ready.correction.ordinary.arm, ready.tree, None)
    found = pinocchio_frequencies(text, RV, ready.tree.elastic, springs_of(text))
    # With the weight of the base itself, which the arm's equations leave out.
    assert found == pytest.approx(own_frequencies(ready), rel=2e-3)


def test_a_user_s_urdf_keeps_its_meshes_and_comments(tmp_path):
    mesh = '<visual><geometry><mesh filename="package://mine/arm.stl"/></geometry></visual>'
    marked = f'<link name="forearm"><!-- kept inside -->{mesh}'
    text = RV.urdf_text.replace('<link name="forearm">', marked, 1)
    path = tmp_path / "mine.urdf"
    path.write_text(text, encoding="utf-8")
    arm = with_effects(RV, axis("elbow"))
    patched, _ = patched_urdf(arm, ready_for_export(arm).tree, path)
    assert "package://mine/arm.stl" in patched
    assert "<!-- Mitsubishi RV-4FRL" in patched
    assert "kept inside" in patched


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace('"joint_3"', '"other"'), "wanted the joints joint_1"),
        (lambda t: t.replace("0 0 0.31", "0 0 0.41"), "wanted joint_3 where arm"),
        (lambda t: t[:-20], "wanted XML"),
    ],
)
def test_another_arm_s_urdf_is_refused(change, message, tmp_path):
    path = tmp_path / "mine.urdf"
    path.write_text(change(RV.urdf_text), encoding="utf-8")
    with pytest.raises(ArmError, match=message):
        patched_urdf(RV, ready_for_export(RV).tree, path)


@pytest.mark.parametrize("form", [urdf_text, sdf_text])
def test_what_has_no_counterpart_is_named(form):
    several = [any_of(RV, kind) for kind in ("rotor", "servo", "coupling")]
    tree = ready_for_export(with_effects(RV, *several)).tree
    with pytest.raises(ArmError) as refused:
        form(RV, tree)
    for word in ("the rotor servo_compliance_joint_1", "a spring between", "a rotor's inertia on"):
        assert word in str(refused.value)


@pytest.mark.parametrize("kind", [None, "base", "bearing", "link_bending", "payload", "softening"])
def test_sdf_keeps_the_rules_of_its_specification(kind):
    arm = with_effects(RV, axis("elbow"), *([] if kind is None else [any_of(RV, kind)]))
    root = parse_xml(sdf_text(arm, ready_for_export(arm).tree)[0])
    assert faults(root) == []
    # The check sees what is wrong.
    root.find(".//dynamics/spring_stiffness").text = "soft"
    root.find(".//joint/child").text = "nobody"
    root.find(".//axis").append(Element("hinge"))
    assert len(faults(root)) == 4


def test_sdf_stands_as_the_urdf_does_and_has_the_springs():
    arm = with_effects(RV, axis("elbow"), any_of(RV, "bearing"))
    ready = ready_for_export(arm)
    model = parse_xml(sdf_text(arm, ready.tree)[0]).find("model")
    places = {"world": np.eye(4)}
    for link in model.findall("link"):
        pose = link.find("pose")
        T = np.eye(4)
        if pose is not None:
            values = [float(v) for v in pose.text.split()]
            T[:3, 3], T[:3, :3] = values[:3], Rotation.from_euler("xyz", values[3:]).as_matrix()
            T = places[pose.get("relative_to", "world")] @ T
        places[link.get("name")] = T
    superset = ready.correction.ordinary.superset
    for joint, T in zip(arm.joints, superset.posture(np.zeros(6)).T_base_link, strict=True):
        assert places[joint.link.name] == pytest.approx(T, abs=1e-9)
    stiffness = {
        joint.get("name"): float(joint.findtext("axis/dynamics/spring_stiffness"))
        for joint in model.findall("joint")
        if joint.find("axis/dynamics") is not None
    }
    assert set(stiffness) == set(ready.tree.elastic)
    assert stiffness["joint_1_flex"] == RV.joints[0].stiffness.value
    mass = sum(float(link.findtext("inertial/mass")) for link in model.findall("link"))
    assert mass == pytest.approx(sum(joint.link.mass_kg for joint in arm.joints), rel=1e-5)
