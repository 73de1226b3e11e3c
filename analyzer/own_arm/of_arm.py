"""The bodies of an arm that is described already: for checks, points and collisions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from armodal.analyzer.own_arm.bodies import ArmBody, arm_bodies
from armodal.analyzer.own_arm.floor import reach_of
from armodal.protocols.arm.files import BASE
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.chain import Body, CutChain, Part
from armodal.protocols.robot.records import Inertial, RobotJoint, RobotLink
from armodal.protocols.robot.remarks import Remarks, refuse_faults
from armodal.protocols.robot.urdf_tree import read_tree

__all__ = ["bodies_of_arm", "checked_bodies", "off_their_links"]

# Farther than this from its link a point is a mistake: calipers and rulers are better.
_OFF_M = 0.03
_OFF_CAPSULE = 0.5  # of the arm's reach, where a capsule stands for the link


def bodies_of_arm(arm: Arm, folder: Path | None, said: Remarks) -> tuple[ArmBody, ...] | None:
    """Base first; shapes from the arm's URDF and the meshes beside it, else capsules.

    Parameters
    ----------
    folder
        Where the arm file and its meshes lie; None where capsules are to stand for the links.
    """
    shapes = {}
    base_name = None
    if arm.urdf_text is not None and folder is not None:
        robot = read_tree(arm.urdf_text, folder, Remarks())
        if robot is not None:
            shapes = dict(robot.links)
            children = {joint.child for joint in robot.joints}
            base_name = next((name for name in robot.links if name not in children), None)
    bodies, parent = [], BASE
    for joint in arm.joints:
        drawn = shapes.get(joint.link.name)
        link = RobotLink(
            name=joint.link.name,
            inertial=Inertial(
                mass_kg=joint.link.mass_kg,
                center_m=joint.link.center_m,
                inertia_kg_m2=joint.link.inertia_kg_m2,
            ),
            visual=drawn.visual if drawn else (),
            collision=drawn.collision if drawn else (),
        )
        bodies.append(
            Body(
                joint=RobotJoint(
                    name=joint.name,
                    kind="revolute",
                    parent=parent,
                    child=link.name,
                    T_parent_joint=joint.T_parent_joint,
                    axis=joint.axis,
                    range_rad=joint.range_rad,
                ),
                T_parent_joint=joint.T_parent_joint,
                range_rad=joint.range_rad,
                parts=(Part(link=link, T_body_link=np.eye(4)),),
            )
        )
        parent = link.name
    drawn = shapes.get(base_name or BASE)
    stand = RobotLink(
        name=BASE,
        inertial=None,
        visual=drawn.visual if drawn else (),
        collision=drawn.collision if drawn else (),
    )
    base = Body(
        joint=None,
        T_parent_joint=np.eye(4),
        range_rad=(0.0, 0.0),
        parts=(Part(link=stand, T_body_link=np.eye(4)),),
    )
    chain = CutChain(name=arm.name, base=base, bodies=tuple(bodies), tip=parent)
    return arm_bodies(chain, said)


def checked_bodies(arm: Arm, folder: Path | None, said: Remarks) -> tuple[ArmBody, ...]:
    """The bodies of an arm whose points are on them, base first.

    Raises
    ------
    ArmError
        With every fault of its shapes and points.
    """
    bodies = bodies_of_arm(arm, folder, said)
    if bodies is not None:
        off_their_links(arm, bodies, said)
    refuse_faults(f"arm '{arm.name}'", said)
    if bodies is None:  # a fault says why
        raise ArmError(f"arm '{arm.name}': cannot be used")
    return bodies


def off_their_links(arm: Arm, bodies: Sequence[ArmBody], said: Remarks) -> None:
    """Say a fault for every point that lies far off the link it is said to be on."""
    reach = reach_of(arm)
    by_name = {body.name: body for body in bodies}
    for point in arm.points:
        body = by_name[point.link]
        equations = body.seen.hull.equations
        off = float((equations[:, :3] @ point.position_m + equations[:, 3]).max())
        if off > (_OFF_M if body.drawn else _OFF_CAPSULE * reach):
            said.fault(
                f"point {point.id}",
                f"wanted it on link {point.link}, got it {1e3 * off:.0f} mm off; correct "
                "position_m, which is in the link's frame, in m",
            )
