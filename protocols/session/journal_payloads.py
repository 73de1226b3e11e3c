"""Payloads of HIT, LOSS, MARK and END records: from records to bytes and back.

Every encoder checks what the decoder will ask for, so what was written can be read.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal_framing import RecordKind, encode_record
from armodal.protocols.session.journal_models import (
    EndModel,
    HitModel,
    LossModel,
    MarkModel,
    ReadingModel,
    check,
    from_json,
    to_json,
)
from armodal.protocols.session.records import Hit, JointReading, Loss, Verdict

__all__ = [
    "CALIBRATION",
    "End",
    "Mark",
    "MarkKind",
    "decode_end",
    "decode_hit",
    "decode_loss",
    "decode_mark",
    "encode_end",
    "encode_hit",
    "encode_loss",
    "encode_mark",
    "hit_model",
    "join_payload",
    "loss_model",
    "split_payload",
]

_U32 = struct.Struct("<I")
_JSON_LIMIT = 2**20
_UNIT_TOLERANCE = 1e-6


# A note that begins so belongs to the data: it goes into the session file with the hits.
CALIBRATION = "calibration: "


class MarkKind(StrEnum):
    """What happened between hits."""

    POSTURE = "posture"  # begun
    POINT = "point"  # begun
    RESUMED = "resumed"
    SKIPPED = "skipped"  # a point, or with point None a posture
    NOTE = "note"
    WITHDRAWN = "withdrawn"  # an accepted hit, by its number


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A step of the session that is neither hit nor loss."""

    kind: MarkKind
    posture: str | None
    point: str | None
    host_s: float
    note: str = ""
    hit: int | None = None  # the hit withdrawn


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """The session was closed on purpose; `reason` says why in words."""

    reason: str
    host_s: float


def join_payload(text: bytes, raw: bytes) -> bytes:
    """Return a payload of JSON and raw bytes: length of the JSON (u32), JSON, bytes."""
    return b"".join((_U32.pack(len(text)), text, raw))


def split_payload(payload: bytes | memoryview, what: str, limit: int) -> tuple[bytes, bytes]:
    """Part a payload into its JSON and the bytes behind it."""
    view = memoryview(payload)
    if len(view) < _U32.size:
        raise JournalError(f"{what}: {len(view)} bytes are too few to hold a length")
    length = _U32.unpack_from(view)[0]
    if length > min(limit, len(view) - _U32.size):
        raise JournalError(
            f"{what}: {length} bytes of JSON are announced, {len(view) - _U32.size} are there "
            f"and {limit} are allowed"
        )
    end = _U32.size + length
    return bytes(view[_U32.size : end]), bytes(view[end:])


def encode_hit(hit: Hit) -> bytes:
    """Return the HIT record of one hit, accepted or rejected."""
    payload = join_payload(to_json(hit_model(hit)), hit.counts.astype("<i4").tobytes())
    return encode_record(RecordKind.HIT, payload)


def hit_model(hit: Hit) -> HitModel:
    """Return what is stored of `hit` beside its counts, or raise JournalError."""
    if hit.counts.ndim != 2:
        raise JournalError(f"counts of shape (n, channels) were wanted, {hit.counts.shape} came")
    model = check(
        HitModel,
        {
            "number": int(hit.number),
            "posture": hit.posture,
            "sensor_point": hit.sensor_point,
            "hit_point": hit.hit_point,
            "hit_direction": tuple(hit.hit_direction.tolist()),
            "first_sample": int(hit.first_sample),
            "trigger_sample": int(hit.trigger_sample),
            "trigger_host_s": float(hit.trigger_host_s),
            "n_samples": hit.counts.shape[0],
            "n_channels": hit.counts.shape[1],
            "before": _reading_values(hit.before),
            "after": _reading_values(hit.after),
            "verdict": {
                "accepted": bool(hit.verdict.accepted),
                "reasons": hit.verdict.reasons,
                "notes": hit.verdict.notes,
                "peak_n": _finite(hit.verdict.peak_n),
                "width_s": _finite(hit.verdict.width_s),
                "polarity": int(hit.verdict.polarity),
            },
        },
        f"hit {hit.number}",
    )
    _check_direction(model)
    return model


def decode_hit(payload: bytes | memoryview) -> Hit:
    """Return the hit of a HIT record."""
    text, raw = split_payload(payload, "HIT", _JSON_LIMIT)
    model = from_json(HitModel, text, "HIT", _JSON_LIMIT)
    _check_direction(model)
    wanted = 4 * model.n_samples * model.n_channels
    if len(raw) != wanted:
        raise JournalError(
            f"hit {model.number}: {model.n_samples} samples of {model.n_channels} channels want "
            f"{wanted} bytes of counts, {len(raw)} came"
        )
    counts = np.frombuffer(raw, dtype="<i4").reshape(model.n_samples, model.n_channels)
    verdict = model.verdict
    return Hit(
        number=model.number,
        posture=model.posture,
        sensor_point=model.sensor_point,
        hit_point=model.hit_point,
        hit_direction=frozen_array(model.hit_direction, np.float64),
        first_sample=model.first_sample,
        trigger_sample=model.trigger_sample,
        trigger_host_s=model.trigger_host_s,
        counts=frozen_array(counts, np.int32),
        before=_reading(model.before),
        after=_reading(model.after),
        verdict=Verdict(
            accepted=verdict.accepted,
            reasons=verdict.reasons,
            notes=verdict.notes,
            peak_n=math.nan if verdict.peak_n is None else verdict.peak_n,
            width_s=math.nan if verdict.width_s is None else verdict.width_s,
            polarity=verdict.polarity,
        ),
    )


def encode_loss(loss: Loss) -> bytes:
    """Return the LOSS record of something that did not arrive."""
    return encode_record(RecordKind.LOSS, to_json(loss_model(loss)))


def loss_model(loss: Loss) -> LossModel:
    """Return what is stored of `loss`, or raise JournalError."""
    return check(
        LossModel,
        {
            "kind": loss.kind,
            "count": int(loss.count),
            "first_sample": None if loss.first_sample is None else int(loss.first_sample),
            "host_s": float(loss.host_s),
            "note": loss.note,
        },
        "loss",
    )


def decode_loss(payload: bytes | memoryview) -> Loss:
    """Return the loss of a LOSS record."""
    model = from_json(LossModel, payload, "LOSS", _JSON_LIMIT)
    return Loss(
        kind=model.kind,
        count=model.count,
        first_sample=model.first_sample,
        host_s=model.host_s,
        note=model.note,
    )


def encode_mark(mark: Mark) -> bytes:
    """Return the MARK record of a step of the session."""
    model = check(
        MarkModel,
        {
            "kind": mark.kind.value,
            "posture": mark.posture,
            "point": mark.point,
            "host_s": mark.host_s,
            "note": mark.note,
            "hit": mark.hit,
        },
        "mark",
    )
    return encode_record(RecordKind.MARK, to_json(model))


def decode_mark(payload: bytes | memoryview) -> Mark:
    """Return the mark of a MARK record."""
    model = from_json(MarkModel, payload, "MARK", _JSON_LIMIT)
    try:
        kind = MarkKind(model.kind)
    except ValueError:
        known = ", ".join(MarkKind)
        raise JournalError(f"MARK: kind is one of {known}, {model.kind!r} came") from None
    return Mark(
        kind=kind,
        posture=model.posture,
        point=model.point,
        host_s=model.host_s,
        note=model.note,
        hit=model.hit,
    )


def encode_end(end: End) -> bytes:
    """Return the END record of a session closed on purpose."""
    model = check(EndModel, {"reason": end.reason, "host_s": end.host_s}, "end")
    return encode_record(RecordKind.END, to_json(model))


def decode_end(payload: bytes | memoryview) -> End:
    """Return the end of an END record."""
    model = from_json(EndModel, payload, "END", _JSON_LIMIT)
    return End(reason=model.reason, host_s=model.host_s)


def _check_direction(model: HitModel) -> None:
    length = math.hypot(*model.hit_direction)
    if abs(length - 1) > _UNIT_TOLERANCE:
        raise JournalError(
            f"hit {model.number}: hit_direction is a unit vector, one of length {length:g} came"
        )


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _reading_values(reading: JointReading) -> dict[str, object]:
    joints = reading.joints_rad
    return {
        "joints_rad": None if joints is None else tuple(joints.tolist()),
        "drive_state": None if reading.drive_state is None else int(reading.drive_state),
        "held": bool(reading.held),
        "age_s": _finite(reading.age_s),
        "host_s": float(reading.host_s),
    }


def _reading(model: ReadingModel) -> JointReading:
    return JointReading(
        joints_rad=None if model.joints_rad is None else frozen_array(model.joints_rad, np.float64),
        drive_state=model.drive_state,
        held=model.held,
        age_s=math.inf if model.age_s is None else model.age_s,
        host_s=model.host_s,
    )
