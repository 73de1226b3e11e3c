"""A corrected arm as MJCF of its own: bodies, joints with springs, tendons between joints.

MuJoCo, documentation, XML reference: `joint` (stiffness, damping, armature), `tendon/fixed`.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.export.tree import Between, Freedom, Rotor, Tree, TreeBody
from armodal.protocols.arm.records import Arm

__all__ = ["between_elements", "inertial_element", "joint_element", "mjcf_text", "rotor_element"]

Array = npt.NDArray[np.float64]

# A driven joint with its elastic twin on the same line needs an inertia of its own, else the mass
# matrix is singular; what it is makes no difference while the joint is held.
DRIVE_ARMATURE = 0.01  # kg m^2
_ROTOR_KG = 1e-3  # of a body that turns about its own centre: its mass acts on nothing


def mjcf_text(arm: Arm, tree: Tree) -> str:
    """Return an arm as MJCF, without meshes."""
    root = ET.Element("mujoco", model=arm.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    ET.SubElement(root, "option", gravity=numbers(arm.gravity_m_s2), integrator="implicitfast")
    world = ET.SubElement(root, "worldbody")
    at = {"": world}
    for body in tree.bodies:
        element = ET.SubElement(at[body.parent], "body", name=body.name)
        element.set("pos", numbers(body.T_parent_body[:3, 3]))
        element.set("quat", numbers(_quaternion(body.T_parent_body[:3, :3])))
        if body.link < 0:  # the arm's equations leave its weight out, as it stands on its springs
            element.set("gravcomp", "1")
        for freedom in body.freedoms:
            element.append(joint_element(freedom))
        if body.mass_kg > 0.0:
            element.append(inertial_element(body))
        for point in arm.points:
            if point.link == body.name:
                site = ET.SubElement(element, "site", name=f"point_{point.id}")
                site.set("pos", numbers(point.position_m))
                site.set("quat", numbers(_quaternion(point.R_link_sensor)))
        at[body.name] = element
    for rotor in tree.rotors:
        world.append(rotor_element(rotor))
    tendons = list(between_elements(tree.between))
    if tendons:
        ET.SubElement(root, "tendon").extend(tendons)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def joint_element(freedom: Freedom) -> ET.Element:
    """Return a joint."""
    element = ET.Element("joint", name=freedom.name, type="slide" if freedom.slides else "hinge")
    element.set("axis", numbers(freedom.axis))
    element.set("pos", numbers(freedom.point_m))
    if freedom.driven:
        element.set("armature", repr(DRIVE_ARMATURE))
        if freedom.range_rad is not None and np.isfinite(freedom.range_rad).all():
            element.set("range", numbers(np.array(freedom.range_rad)))
        return element
    element.set("stiffness", repr(freedom.stiffness))
    element.set("damping", repr(freedom.damping))
    element.set("armature", repr(freedom.armature))
    element.set("limited", "false")
    element.set("frictionloss", "0")
    return element


def inertial_element(body: TreeBody) -> ET.Element:
    """Return a body's mass, centre and inertia."""
    J = body.inertia_kg_m2
    element = ET.Element("inertial", mass=repr(body.mass_kg), pos=numbers(body.center_m))
    full = np.array([J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
    element.set("fullinertia", numbers(full))
    return element


def rotor_element(rotor: Rotor) -> ET.Element:
    """Return a rotor as a body of the world that turns about its own centre."""
    own = rotor.freedom
    body = ET.Element("body", name=f"{own.name}_body")
    body.append(joint_element(own))
    inertial = ET.SubElement(body, "inertial", mass=repr(_ROTOR_KG), pos="0 0 0")
    inertial.set("diaginertia", numbers(np.full(3, _ROTOR_KG * 1e-6)))
    return body


def between_elements(between: Iterable[Between]) -> Iterable[ET.Element]:
    """Yield a fixed tendon for each spring between two joints."""
    for own in between:
        tendon = ET.Element("fixed", name=own.name)
        tendon.set("stiffness", repr(own.stiffness))
        tendon.set("damping", repr(own.damping))
        tendon.set("springlength", "0")
        ET.SubElement(tendon, "joint", joint=own.first, coef="1")
        ET.SubElement(tendon, "joint", joint=own.second, coef=repr(own.ratio))
        yield tendon


def numbers(values: Array) -> str:
    """Return numbers as an attribute holds them, none lost."""
    return " ".join(repr(float(value)) for value in values)


def _quaternion(R: Array) -> Array:
    return np.asarray(scipy.spatial.transform.Rotation.from_matrix(R).as_quat(scalar_first=True))
