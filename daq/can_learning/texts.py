"""A DBC and a `[can]` section of what was learned."""

from __future__ import annotations

import json

from armodal.daq.can_learning.fields import Field, Kind
from armodal.daq.can_learning.learn import Learned, LearnedJoint

__all__ = ["can_section_text", "database_text"]

COUNTER = "COUNTER"


def database_text(learned: Learned) -> str:
    """Return the text of a DBC: a message for each identifier that carries a joint, in degrees."""
    lines = ['VERSION "1"', "", "NS_ :", "", "BS_:", "", "BU_: CONTROLLER LISTENER", ""]
    floats = []
    for key in _keys(learned):
        can_id, extended = key
        number = can_id | (0x80000000 if extended else 0)
        lines.append(f"BO_ {number} {_message(key)}: {learned.lengths[key]} CONTROLLER")
        for i, joint in enumerate(learned.joints, 1):
            if _key(joint.field) != key:
                continue
            lines.append(f' SG_ {_signal(i)} : {_bits(joint)} "deg" LISTENER')
            if joint.field.format.kind is Kind.FLOAT:
                kind = 1 if joint.field.format.n_bytes == 4 else 2
                floats.append(f"SIG_VALTYPE_ {number} {_signal(i)} : {kind};")
        if key in learned.counters and not _taken(learned, key, learned.counters[key]):
            lines.append(
                f' SG_ {COUNTER} : {8 * learned.counters[key]}|8@1+ (1,0) [0|255] "" LISTENER'
            )
        lines.append("")
    return "\n".join([*lines, *floats]) + "\n"


def can_section_text(
    learned: Learned, *, database: str, bitrate: int, rate_hz: float, stale_after_s: float = 0.5
) -> str:
    """Return the text of the section; the drive state cannot be learned, and is left out."""
    lines = [
        "[can]",
        f"database = {json.dumps(database)}",
        f"bitrate = {bitrate}",
        f"rate_hz = {rate_hz:.4g}",
        f"stale_after_s = {max(stale_after_s, 5.0 / rate_hz):.3g}",
    ]
    counted = [
        key
        for key in _keys(learned)
        if key in learned.counters and not _taken(learned, key, learned.counters[key])
    ]
    if counted:
        lines.append(f'counter = {{ message = "{_message(counted[0])}", signal = "{COUNTER}" }}')
    lines.append("joints = [")
    for i, joint in enumerate(learned.joints, 1):
        lines.append(
            f"    {{ joint = {json.dumps(joint.joint)}, message = "
            f'"{_message(_key(joint.field))}", signal = "{_signal(i)}", scale_deg = 1.0, '
            "sign = 1, offset_deg = 0.0 },"
        )
    return "\n".join([*lines, "]"]) + "\n"


def _key(field: Field) -> tuple[int, bool]:
    return field.can_id, field.extended


def _keys(learned: Learned) -> list[tuple[int, bool]]:
    return sorted({_key(joint.field) for joint in learned.joints})


def _message(key: tuple[int, bool]) -> str:
    return f"FRAME_{key[0]:X}"


def _signal(number: int) -> str:
    return f"POSITION_{number}"


def _bits(joint: LearnedJoint) -> str:
    """Start, length, order, sign, factor and offset, as a DBC writes them."""
    form, first = joint.field.format, joint.field.first_byte
    start = 8 * first if form.little_endian else 8 * first + 7
    order = 1 if form.little_endian else 0
    sign = "+" if form.kind is Kind.UNSIGNED else "-"
    return (
        f"{start}|{8 * form.n_bytes}@{order}{sign} "
        f"({joint.factor_deg!r},{joint.offset_deg!r}) [0|0]"
    )


def _taken(learned: Learned, key: tuple[int, bool], byte: int) -> bool:
    return any(_key(j.field) == key and byte in j.field.bytes for j in learned.joints)
