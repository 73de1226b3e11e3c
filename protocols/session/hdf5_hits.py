"""Hits and losses in the session file: columns for what is told of them, one NXdata a hit."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import JournalError
from armodal.protocols.session.hdf5_tree import Tree, add_array, add_group, add_texts
from armodal.protocols.session.journal_payloads import hit_model, loss_model
from armodal.protocols.session.membership import check_membership
from armodal.protocols.session.records import Hit, JointReading, Loss, SessionHeader, Verdict

__all__ = ["read_hits", "read_losses", "write_hits", "write_losses"]

MAX_SAMPLES = 2**24


def hit_name(number: int) -> str:
    """Return the name of the group that holds one hit's counts.

    >>> hit_name(7)
    'hit_0007'
    """
    return f"hit_{number:04d}"


def write_hits(entry: h5py.Group, header: SessionHeader, hits: Sequence[Hit]) -> None:
    """Write the group `hits`; the first hit is linked as `first_hit` for viewers."""
    group = add_group(entry, "hits", "NXcollection")
    _write_table(add_group(group, "table", "NXcollection"), header, hits)
    axes: dict[tuple[int, int], h5py.Dataset] = {}
    rate_hz = float(header.plan.sampling.rate_hz)
    for hit in hits:
        n = hit.counts.shape[0]
        lead = hit.trigger_sample - hit.first_sample
        data = add_group(
            group,
            hit_name(hit.number),
            "NXdata",
            signal="counts",
            axes=[".", "time_s"],
            time_s_indices=1,
        )
        add_array(data, "counts", hit.counts.T, units="counts", interpretation="spectrum")
        if (n, lead) in axes:
            data["time_s"] = axes[n, lead]
        else:
            time_s = (np.arange(n) - lead) / rate_hz
            axes[n, lead] = add_array(data, "time_s", time_s, units="s", long_name="time (s)")
    if hits:
        group.attrs["default"] = hit_name(hits[0].number)
        entry["first_hit"] = group[hit_name(hits[0].number)]


def read_hits(entry: Tree, header: SessionHeader) -> tuple[Hit, ...]:
    """Read the hits and check each against its checksum, the plan and the arm."""
    group = entry.group("hits")
    table = group.group("table")
    columns = _read_table(table, header)
    channels = header.channel_mask.bit_count()
    hits: list[Hit] = []
    for row, number in enumerate(columns["number"]):
        name = hit_name(int(number))
        stored = group.group(name).array("counts", np.int32, (channels, None), limit=MAX_SAMPLES)
        counts = frozen_array(stored.T, np.int32)
        if zlib.crc32(counts.data) != columns["counts_crc32"][row]:
            group.refuse(name, f"counts with CRC-32 {columns['counts_crc32'][row]:#010x}", "others")
        hit = _hit(table, columns, row, counts)
        try:
            hit_model(hit)
            check_membership(hit, header, hits[-1] if hits else None)
        except JournalError as error:
            group.refuse(name, "a hit of this session", str(error))
        hits.append(hit)
    return tuple(hits)


def write_losses(entry: h5py.Group, losses: Sequence[Loss]) -> None:
    """Write the group `losses`."""
    group = add_group(entry, "losses", "NXcollection")
    add_texts(group, "kind", [loss.kind for loss in losses])
    add_array(group, "count", np.array([loss.count for loss in losses], dtype=np.int64))
    first = [-1 if loss.first_sample is None else loss.first_sample for loss in losses]
    add_array(group, "first_sample", np.array(first, dtype=np.int64))
    host_s = np.array([loss.host_s for loss in losses], dtype=np.float64)
    add_array(group, "host_s", host_s, units="s")
    add_texts(group, "note", [loss.note for loss in losses])


def read_losses(entry: Tree) -> tuple[Loss, ...]:
    """Read the losses."""
    group = entry.group("losses")
    kinds = group.texts("kind")
    n = len(kinds)
    counts = group.array("count", np.int64, (n,))
    firsts = group.array("first_sample", np.int64, (n,))
    host_s = group.finite("host_s", (n,))
    notes = group.texts("note", n)
    losses = tuple(
        Loss(
            kind=kinds[i],
            count=int(counts[i]),
            first_sample=None if firsts[i] == -1 else int(firsts[i]),
            host_s=float(host_s[i]),
            note=notes[i],
        )
        for i in range(n)
    )
    for i, loss in enumerate(losses):
        try:
            loss_model(loss)
        except JournalError as error:
            group.refuse(f"row {i}", "a loss", str(error))
    return losses


def _write_table(table: h5py.Group, header: SessionHeader, hits: Sequence[Hit]) -> None:
    def texts(name: str, values: Iterable[str]) -> None:
        add_texts(table, name, list(values))

    def numbers(name: str, values: Iterable[float], dtype: npt.DTypeLike, units: str = "") -> None:
        attributes = {"units": units} if units else {}
        add_array(table, name, np.array(list(values), dtype=dtype), **attributes)

    numbers("number", (hit.number for hit in hits), np.int64)
    texts("posture", (hit.posture for hit in hits))
    texts("sensor_point", (hit.sensor_point for hit in hits))
    texts("hit_point", (hit.hit_point for hit in hits))
    directions = np.array([hit.hit_direction for hit in hits], dtype=np.float64)
    add_array(table, "hit_direction", directions.reshape(len(hits), 3))
    numbers("first_sample", (hit.first_sample for hit in hits), np.int64)
    numbers("trigger_sample", (hit.trigger_sample for hit in hits), np.int64)
    numbers("trigger_host_s", (hit.trigger_host_s for hit in hits), np.float64, "s")
    crcs = (zlib.crc32(np.ascontiguousarray(hit.counts).data) for hit in hits)
    numbers("counts_crc32", crcs, np.uint32)
    numbers("accepted", (hit.verdict.accepted for hit in hits), np.uint8)
    texts("reasons", (json.dumps(hit.verdict.reasons, ensure_ascii=False) for hit in hits))
    texts("notes", (json.dumps(hit.verdict.notes, ensure_ascii=False) for hit in hits))
    numbers("peak_n", (hit.verdict.peak_n for hit in hits), np.float64, "N")
    numbers("width_s", (hit.verdict.width_s for hit in hits), np.float64, "s")
    numbers("polarity", (hit.verdict.polarity for hit in hits), np.int8)
    for name in ("before", "after"):
        group = add_group(table, name, "NXcollection")
        _write_readings(group, [getattr(hit, name) for hit in hits], len(header.arm.joints))


def _write_readings(group: h5py.Group, readings: Sequence[JointReading], n_joints: int) -> None:
    joints = np.full((len(readings), n_joints), np.nan)
    for row, reading in zip(joints, readings, strict=True):
        if reading.joints_rad is not None:
            row[:] = reading.joints_rad
    known = [reading.joints_rad is not None for reading in readings]
    states = [0 if reading.drive_state is None else reading.drive_state for reading in readings]
    state_known = [reading.drive_state is not None for reading in readings]
    add_array(group, "joints_known", np.array(known, dtype=np.uint8))
    add_array(group, "joints_rad", joints, units="rad")
    add_array(group, "drive_state_known", np.array(state_known, dtype=np.uint8))
    add_array(group, "drive_state", np.array(states, dtype=np.int64))
    add_array(group, "held", np.array([reading.held for reading in readings], dtype=np.uint8))
    age_s = np.array([reading.age_s for reading in readings], dtype=np.float64)
    add_array(group, "age_s", age_s, units="s")
    host_s = np.array([reading.host_s for reading in readings], dtype=np.float64)
    add_array(group, "host_s", host_s, units="s")


def _read_table(table: Tree, header: SessionHeader) -> dict[str, Any]:
    number = table.array("number", np.int64, (None,))
    if (number < 1).any() or (number >= 2**31).any():
        table.refuse("number", "hit numbers from 1", f"{number.min()} to {number.max()}")
    n = len(number)
    return {
        "number": number,
        "posture": table.texts("posture", n),
        "sensor_point": table.texts("sensor_point", n),
        "hit_point": table.texts("hit_point", n),
        "hit_direction": table.finite("hit_direction", (n, 3)),
        "first_sample": table.array("first_sample", np.int64, (n,)),
        "trigger_sample": table.array("trigger_sample", np.int64, (n,)),
        "trigger_host_s": table.finite("trigger_host_s", (n,)),
        "counts_crc32": table.array("counts_crc32", np.uint32, (n,)),
        "accepted": table.flags("accepted", (n,)),
        "reasons": table.texts("reasons", n),
        "notes": table.texts("notes", n),
        "peak_n": table.array("peak_n", np.float64, (n,)),
        "width_s": table.array("width_s", np.float64, (n,)),
        "polarity": _read_polarity(table, n),
        "before": _read_readings(table.group("before"), n, len(header.arm.joints)),
        "after": _read_readings(table.group("after"), n, len(header.arm.joints)),
    }


def _read_polarity(table: Tree, n: int) -> npt.NDArray[np.int8]:
    """Signs of the recorded force; files without them have hammers that read a push as positive."""
    if not table.has("polarity"):
        return np.ones(n, dtype=np.int8)
    signs: npt.NDArray[np.int8] = table.array("polarity", np.int8, (n,))
    if (np.abs(signs) != 1).any():
        table.refuse("polarity", "1 and -1", str(signs[np.abs(signs) != 1][0]))
    return signs


def _read_readings(group: Tree, n: int, n_joints: int) -> tuple[JointReading, ...]:
    known = group.flags("joints_known", (n,))
    joints = group.array("joints_rad", np.float64, (n, n_joints))
    state_known = group.flags("drive_state_known", (n,))
    states = group.array("drive_state", np.int64, (n,))
    held = group.flags("held", (n,))
    ages = group.array("age_s", np.float64, (n,))
    host_s = group.finite("host_s", (n,))
    return tuple(
        JointReading(
            joints_rad=frozen_array(joints[i], np.float64) if known[i] else None,
            drive_state=int(states[i]) if state_known[i] else None,
            held=bool(held[i]),
            age_s=float(ages[i]),
            host_s=float(host_s[i]),
        )
        for i in range(n)
    )


def _hit(table: Tree, columns: dict[str, Any], row: int, counts: npt.NDArray[np.int32]) -> Hit:
    return Hit(
        number=int(columns["number"][row]),
        posture=columns["posture"][row],
        sensor_point=columns["sensor_point"][row],
        hit_point=columns["hit_point"][row],
        hit_direction=frozen_array(columns["hit_direction"][row], np.float64),
        first_sample=int(columns["first_sample"][row]),
        trigger_sample=int(columns["trigger_sample"][row]),
        trigger_host_s=float(columns["trigger_host_s"][row]),
        counts=counts,
        before=columns["before"][row],
        after=columns["after"][row],
        verdict=Verdict(
            accepted=bool(columns["accepted"][row]),
            reasons=_words(table, "reasons", columns["reasons"][row]),
            notes=_words(table, "notes", columns["notes"][row]),
            peak_n=float(columns["peak_n"][row]),
            width_s=float(columns["width_s"][row]),
            polarity=int(columns["polarity"][row]),
        ),
    )


def _words(table: Tree, name: str, text: str) -> tuple[str, ...]:
    """Return the strings of a JSON list."""
    try:
        words = json.loads(text)
    except (ValueError, RecursionError):
        words = None
    if not isinstance(words, list) or not all(isinstance(word, str) for word in words):
        table.refuse(name, "a JSON list of strings", repr(text[:100]))
    return tuple(words)
