"""The CAN section of an arm file, checked against its database."""

from __future__ import annotations

import math
from collections.abc import Sequence

from armodal.protocols.arm.file_model import CanSection
from armodal.protocols.arm.records import CanMapping, DriveStateSignal, JointSignal
from armodal.protocols.can_database import CanDecoder, load_database, mapped_message
from armodal.protocols.errors import ArmError, CanError
from armodal.protocols.toml_reader import refuse

__all__ = ["can_mapping"]


def can_mapping(
    section: CanSection, *, database_text: str, joints: Sequence[str], origin: str
) -> CanMapping:
    """Return the mapping, every signal of which the database holds.

    Raises
    ------
    ArmError
        With the key's path, if a joint is missing, unknown or given twice, or a message or signal
        is not in the database.
    """
    try:
        database = load_database(database_text, section.database)
    except CanError as problem:
        raise ArmError(f"{origin}: can.database: {problem}") from problem
    signals: list[tuple[str, str, str, bool]] = []
    seen: set[str] = set()
    for index, table in enumerate(section.joints):
        path = f"can.joints[{index}]"
        if table.joint not in joints or table.joint in seen:
            wanted = f"each of {', '.join(joints)} once"
            refuse(ArmError, origin, f"{path}.joint", wanted=wanted, got=table.joint)
        seen.add(table.joint)
        signals.append((path, table.message, table.signal, False))
    if missing := [name for name in joints if name not in seen]:
        refuse(ArmError, origin, "can.joints", wanted="a signal for every joint", got=missing)
    if section.drive_state is not None:
        state = section.drive_state
        signals.append(("can.drive_state", state.message, state.signal, True))
    if section.counter is not None:
        counter = section.counter
        signals.append(("can.counter", counter.message, counter.signal, True))
    for path, message, signal, number in signals:
        try:
            mapped_message(database, message, signal, number=number)
        except CanError as problem:
            raise ArmError(f"{origin}: {path}: {problem}") from problem
    mapping = CanMapping(
        database=section.database,
        database_text=database_text,
        bitrate=section.bitrate,
        rate_hz=section.rate_hz,
        stale_after_s=section.stale_after_s,
        joints=tuple(
            JointSignal(
                joint=table.joint,
                message=table.message,
                signal=table.signal,
                scale_rad=table.scale_rad,
                sign=table.sign,
                offset_rad=math.radians(table.offset_deg),
            )
            for table in section.joints
        ),
        drive_state=None
        if section.drive_state is None
        else DriveStateSignal(
            message=section.drive_state.message,
            signal=section.drive_state.signal,
            held_values=tuple(section.drive_state.held_values),
        ),
        counter=None
        if section.counter is None
        else (section.counter.message, section.counter.signal),
    )
    try:
        CanDecoder(mapping)
    except CanError as problem:
        raise ArmError(f"{origin}: can: {problem}") from problem
    return mapping
