"""Element rules of SDFormat 1.9 for what armodal writes, from its specification (sdformat.org).

Of each element: attributes that must be there or may be; children that must be there once, may be
there once, or any number of times; what its text is. What the specification has beside these is not
written and counts as a fault here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree.ElementTree import Element

NUMBER, VECTOR, POSE, WORDS, NOTHING = "a number", "3 numbers", "6 numbers", "a text", "no text"


@dataclass(frozen=True)
class Rule:
    text: str = NOTHING
    attributes: tuple[str, ...] = ()
    optional_attributes: tuple[str, ...] = ()
    once: tuple[str, ...] = ()
    at_most_once: tuple[str, ...] = ()
    many: tuple[str, ...] = ()


RULES = {
    "sdf": Rule(attributes=("version",), once=("model",)),
    "model": Rule(attributes=("name",), at_most_once=("static", "pose"), many=("link", "joint")),
    "link": Rule(attributes=("name",), at_most_once=("pose", "inertial")),
    "pose": Rule(POSE, optional_attributes=("relative_to",)),
    "inertial": Rule(at_most_once=("pose", "mass", "inertia")),
    "mass": Rule(NUMBER),
    "inertia": Rule(once=("ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
    **{name: Rule(NUMBER) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")},
    "joint": Rule(
        attributes=("name", "type"), once=("parent", "child"), at_most_once=("axis", "pose")
    ),
    "parent": Rule(WORDS),
    "child": Rule(WORDS),
    "axis": Rule(once=("xyz", "limit"), at_most_once=("dynamics",)),
    "xyz": Rule(VECTOR, optional_attributes=("expressed_in",)),
    "limit": Rule(once=("lower", "upper"), at_most_once=("effort", "velocity")),
    "dynamics": Rule(
        once=("spring_reference", "spring_stiffness"), at_most_once=("damping", "friction")
    ),
    **{
        name: Rule(NUMBER)
        for name in (
            "lower",
            "upper",
            "effort",
            "velocity",
            "damping",
            "friction",
            "spring_reference",
            "spring_stiffness",
        )
    },
}
JOINT_TYPES = {
    "continuous", "revolute", "gearbox", "revolute2", "prismatic", "ball", "screw", "universal",
    "fixed",
}  # fmt: skip
_COUNT = {NUMBER: 1, VECTOR: 3, POSE: 6}


def faults(root: Element) -> list[str]:
    """What is against the rules, with the element's path."""
    found = _of_element(root, root.tag)
    for model in root.iter("model"):
        found += _of_model(model)
    return found


def _of_element(element: Element, path: str) -> list[str]:
    rule = RULES.get(element.tag)
    if rule is None:
        return [f"{path}: not an element that is written"]
    allowed = {*rule.attributes, *rule.optional_attributes}
    found = [f"{path}: attribute {name}" for name in element.attrib if name not in allowed]
    found += [f"{path}: without {name}" for name in rule.attributes if not element.get(name)]
    tags = [child.tag for child in element]
    found += [
        f"{path}: {tags.count(name)} of {name}" for name in rule.once if tags.count(name) != 1
    ]
    found += [f"{path}: {tags.count(t)} of {t}" for t in rule.at_most_once if tags.count(t) > 1]
    children = {*rule.once, *rule.at_most_once, *rule.many}
    found += [f"{path}: {tag} in it" for tag in tags if tag not in children]
    text = (element.text or "").strip()
    if rule.text == NOTHING and text:
        found.append(f"{path}: text {text!r}")
    if rule.text == WORDS and not text:
        found.append(f"{path}: no text")
    if rule.text in _COUNT:
        parts = text.split()
        try:
            numbers = [float(part) for part in parts]
        except ValueError:
            numbers = []
        if len(numbers) != _COUNT[rule.text] or not all(map(math.isfinite, numbers)):
            found.append(f"{path}: wanted {rule.text}, got {text!r}")
    for child in element:
        found += _of_element(child, f"{path}/{child.tag}")
    return found


def _of_model(model: Element) -> list[str]:
    """Names are unique and not reserved; frames and joints are of links that are there."""
    links = [link.get("name", "") for link in model.findall("link")]
    names = links + [joint.get("name", "") for joint in model.findall("joint")]
    found = [f"{name} is there twice" for name in sorted(set(names)) if names.count(name) > 1]
    found += [f"the name {name} is reserved" for name in names if name == "world" or "__" in name]
    children = []
    for joint in model.findall("joint"):
        if joint.get("type") not in JOINT_TYPES:
            found.append(f"joint {joint.get('name')}: type {joint.get('type')}")
        if joint.get("type") != "fixed" and joint.find("axis") is None:
            found.append(f"joint {joint.get('name')}: no axis")
        parent, child = joint.findtext("parent"), joint.findtext("child")
        found += [
            f"joint {joint.get('name')}: no link {link}"
            for link in (parent, child)
            if link not in {*links, "world"}
        ]
        children.append(child)
        if child in {parent, "world"}:
            found.append(f"joint {joint.get('name')}: {parent} carries {child}")
    found += [f"{name} hangs on two joints" for name in set(children) if children.count(name) > 1]
    found += [
        f"link {link.get('name')}: no frame {pose.get('relative_to')}"
        for link in model.findall("link")
        for pose in link.findall("pose")
        if pose.get("relative_to", "__model__") not in {*names, "__model__"}
    ]
    return found
