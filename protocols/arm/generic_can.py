"""The `[can]` section of a controller that speaks armodal's own description, one to nine joints."""

from __future__ import annotations

import json
from collections.abc import Sequence

from armodal.protocols.arm.can_section import can_mapping
from armodal.protocols.arm.file_model import CanSection
from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import Arm, CanMapping
from armodal.protocols.can_database import DBC_DIRECTORY
from armodal.protocols.errors import ArmError, CanError
from armodal.protocols.toml_reader import parse_toml, validate

__all__ = ["MOST_JOINTS", "generic_mapping", "generic_section", "with_generic_can"]

MOST_JOINTS = 9
DATABASE = "nine_joints.dbc"


def generic_section(joints: Sequence[str]) -> str:
    """Return the text of a `[can]` section for joints named from the base outwards.

    Raises
    ------
    CanError
        If there are none, or more than nine.
    """
    if not 1 <= len(joints) <= MOST_JOINTS:
        raise CanError(
            f"the generic CAN description: wanted 1 to {MOST_JOINTS} joints, got {len(joints)}; "
            "write a DBC of what the controller sends, and put it beside the arm file"
        )
    lines = [
        "[can]",
        f'database = "{DATABASE}"',
        "bitrate = 500000",
        "rate_hz = 125.0",
        "stale_after_s = 0.5",
        'drive_state = { message = "JOINTS_1_2", signal = "DRIVE_STATE", held_values = [2] }',
        'counter = { message = "JOINTS_1_2", signal = "COUNTER" }',
        "joints = [",
    ]
    for number, joint in enumerate(joints, 1):
        lines.append(
            f'    {{ joint = {json.dumps(joint)}, message = "{_message(number)}", '
            f'signal = "POSITION_{number}", scale_deg = 1.0, sign = 1, offset_deg = 0.0 }},'
        )
    return "\n".join([*lines, "]"]) + "\n"


def generic_mapping(joints: Sequence[str]) -> CanMapping:
    """Return what the generic section says.

    Raises
    ------
    CanError
        If there are no joints, or more than nine.
    """
    origin = "the generic CAN description"
    tables = parse_toml(generic_section(joints), origin=origin, error=ArmError)
    section = validate(CanSection, tables["can"], origin=origin, error=ArmError)
    return can_mapping(section, database_text=_database_text(), joints=joints, origin=origin)


def with_generic_can(arm: Arm) -> Arm:
    """Return the arm with the generic section added to its text, or as it is if it has one.

    Raises
    ------
    CanError
        If it has more than nine joints, or none.
    """
    if arm.can is not None:
        return arm
    section = generic_section([joint.name for joint in arm.joints])
    return arm_from_texts(
        arm.text.rstrip("\n") + "\n\n" + section,
        urdf_text=arm.urdf_text,
        database_text=_database_text(),
        origin=f"arm {arm.name}",
    )


def _message(number: int) -> str:
    """Messages carry two joints each, the last one."""
    first = number - (number - 1) % 2
    return f"JOINTS_{first}" if first == MOST_JOINTS else f"JOINTS_{first}_{first + 1}"


def _database_text() -> str:
    return (DBC_DIRECTORY / DATABASE).read_text(encoding="utf-8")
