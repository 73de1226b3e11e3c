"""Bodies with several joints as links with one joint each, as URDF and SDF want them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.export.tree import Freedom, Tree, TreeBody
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["LIGHT_KG", "LIGHT_KG_M2", "Step", "refuse_without_counterpart", "steps_of"]

Array = npt.NDArray[np.float64]

# Of a link between two joints of one place: simulators refuse to move what has no mass.
LIGHT_KG, LIGHT_KG_M2 = 1e-6, 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A joint and the link behind it, whose frame is on the joint's line."""

    parent: str  # link; "" for the world
    link: str
    T_parent_link: Array  # (4, 4)
    freedom: Freedom | None  # None: fixed
    body: TreeBody | None  # whose mass the link has; None: next to none


def steps_of(body: TreeBody) -> Iterator[Step]:
    """Yield the joints of a body one after the other, the last of them with its own link."""
    parent, T, at = body.parent, body.T_parent_body, np.zeros(3)
    for number, freedom in enumerate(body.freedoms):
        here = np.eye(4)
        here[:3, 3] = freedom.point_m - at
        ends = number + 1 == len(body.freedoms) and not freedom.point_m.any()
        link = body.name if ends else f"{body.name}_at_{freedom.name}"
        yield Step(
            parent=parent,
            link=link,
            T_parent_link=T @ here,
            freedom=freedom,
            body=body if ends else None,
        )
        parent, T, at = link, np.eye(4), freedom.point_m
    if parent != body.name:
        back = np.eye(4)
        back[:3, 3] = -at
        yield Step(parent=parent, link=body.name, T_parent_link=T @ back, freedom=None, body=body)


def refuse_without_counterpart(arm: Arm, tree: Tree, form: str) -> None:
    """Refuse what joints of URDF and SDF cannot have.

    Raises
    ------
    ArmError
        If a rotor, a reflected inertia, or a spring between two joints is there; all are named.
    """
    found = [f"the rotor {rotor.freedom.name}" for rotor in tree.rotors]
    found += [f"a spring between {own.first} and {own.second}" for own in tree.between]
    found += [
        f"a rotor's inertia on {freedom.name}"
        for body in tree.bodies
        for freedom in body.freedoms
        if freedom.armature
    ]
    if found:
        raise ArmError(
            f"arm '{arm.name}': wanted what {form} has a counterpart of, got "
            f"{', '.join(dict.fromkeys(found))}; write --mjcf, which has all of it"
        )
