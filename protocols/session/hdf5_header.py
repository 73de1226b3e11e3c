"""Header, calibration and provenance in the session file."""

from __future__ import annotations

from dataclasses import dataclass

import h5py
import numpy as np

from armodal.protocols.board.dictionary import MAX_DICTIONARY
from armodal.protocols.board.records import BoardDictionary
from armodal.protocols.errors import JournalError
from armodal.protocols.session.hdf5_tree import Tree, add_array, add_group, add_text, add_texts
from armodal.protocols.session.header import header_model, header_of
from armodal.protocols.session.journal_models import HeaderModel, check
from armodal.protocols.session.records import SessionHeader

__all__ = [
    "Provenance",
    "read_header",
    "read_provenance_group",
    "write_header",
    "write_provenance",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """What a session file was derived from, and by what.

    `journal_sha256` is None where the session never was in a journal.
    """

    journal_sha256: str | None
    software: str


def write_header(entry: h5py.Group, header: SessionHeader) -> None:
    """Write what is fixed when a session begins; JournalError if it could not be read back."""
    model = header_model(header)
    add_text(entry, "session_id", model.session_id)
    add_text(entry, "start_time", model.created)
    add_text(entry, "software", model.software)
    add_array(entry, "time_scale", np.array(model.time_scale, dtype=np.float64))
    if model.told_tolerance_rad is not None:
        told = np.array(model.told_tolerance_rad, dtype=np.float64)
        add_array(entry, "told_tolerance_rad", told)
    if model.measured_by:
        add_text(entry, "measured_by", model.measured_by)
    arm = add_group(entry, "arm", "NXcollection")
    add_text(arm, "text", model.arm_text)
    if model.urdf_text is not None:
        add_text(arm, "urdf_text", model.urdf_text)
    if model.database_text is not None:
        add_text(arm, "database_text", model.database_text)
    add_text(arm, "sha256", model.arm_sha256)
    plan = add_group(entry, "plan", "NXcollection")
    add_text(plan, "text", model.plan_text)
    add_text(plan, "sha256", model.plan_sha256)
    board = add_group(entry, "board", "NXcollection")
    add_array(board, "channel_mask", np.array(model.channel_mask, dtype=np.uint64))
    add_array(board, "dictionary", np.frombuffer(header.dictionary_bytes, dtype=np.uint8))
    _write_calibration(board, header.dictionary)


def read_header(entry: Tree) -> SessionHeader:
    """Read the header; arm, plan and dictionary are made anew from their texts and bytes."""
    arm, plan, board = entry.group("arm"), entry.group("plan"), entry.group("board")
    dictionary = board.array("dictionary", np.uint8, (None,), limit=MAX_DICTIONARY).tobytes()
    try:
        model = check(
            HeaderModel,
            {
                "session_id": entry.text("session_id", limit=64),
                "created": entry.text("start_time", limit=1024),
                "software": entry.text("software", limit=1024),
                "arm_text": arm.text("text"),
                "urdf_text": arm.text("urdf_text") if arm.has("urdf_text") else None,
                "database_text": arm.text("database_text") if arm.has("database_text") else None,
                "arm_sha256": arm.text("sha256", limit=64),
                "plan_text": plan.text("text"),
                "plan_sha256": plan.text("sha256", limit=64),
                "channel_mask": int(board.array("channel_mask", np.uint64, ())),
                "time_scale": float(entry.array("time_scale", np.float64, ())),
                "told_tolerance_rad": _told_tolerance_rad(entry),
                "measured_by": (
                    entry.text("measured_by", limit=1024) if entry.has("measured_by") else ""
                ),
            },
            "header",
        )
        header = header_of(model, dictionary)
    except JournalError as error:
        entry.refuse("", "the header of a session", str(error))
    _check_calibration(board, header.dictionary)
    return header


def _told_tolerance_rad(entry: Tree) -> float | None:
    if not entry.has("told_tolerance_rad"):
        return None
    return float(entry.array("told_tolerance_rad", np.float64, ()))


def write_provenance(entry: h5py.Group, provenance: Provenance) -> None:
    """Write what the file was derived from."""
    group = add_group(entry, "provenance", "NXcollection")
    add_text(group, "journal_sha256", provenance.journal_sha256 or "")
    add_text(group, "software", provenance.software)


def read_provenance_group(entry: Tree) -> Provenance:
    """Read what the file was derived from."""
    group = entry.group("provenance")
    digest = group.text("journal_sha256", limit=64)
    if digest and (len(digest) != 64 or set(digest) - set("0123456789abcdef")):
        group.refuse("journal_sha256", "64 hexadecimal digits or nothing", repr(digest))
    return Provenance(journal_sha256=digest or None, software=group.text("software", limit=1024))


def _write_calibration(board: h5py.Group, dictionary: BoardDictionary) -> None:
    """Write the dictionary in words, for those who cannot decode it."""
    add_text(board, "board_id", dictionary.board_id)
    add_text(board, "firmware", dictionary.firmware)
    delay = np.array(dictionary.filter_group_delay_samples, dtype=np.float64)
    add_array(board, "filter_group_delay_samples", delay)
    channels = dictionary.channels
    group = add_group(board, "channels", "NXcollection")
    for name in ("name", "quantity", "unit", "serial_number", "calibration_date"):
        add_texts(group, name, [getattr(channel, name) for channel in channels])
    for name in ("scale", "full_scale", "highpass_hz"):
        values = np.array([getattr(channel, name) for channel in channels], dtype=np.float64)
        add_array(group, name, values)
    add_texts(group, "iepe", [channel.iepe.name.lower() for channel in channels])
    add_texts(group, "teds_hex", [channel.teds.hex() for channel in channels])


def _check_calibration(board: Tree, dictionary: BoardDictionary) -> None:
    """Refuse a file whose calibration in words is not that of its dictionary."""
    group = board.group("channels")
    channels = dictionary.channels
    for name in ("name", "quantity", "unit", "serial_number", "calibration_date"):
        if group.texts(name, len(channels)) != tuple(getattr(c, name) for c in channels):
            group.refuse(name, "what the board's dictionary says", "something else")
    for name in ("scale", "full_scale", "highpass_hz"):
        found = group.array(name, np.float64, (len(channels),))
        if found.tolist() != [getattr(channel, name) for channel in channels]:
            group.refuse(name, "what the board's dictionary says", "something else")
