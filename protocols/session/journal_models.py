"""The JSON inside journal records: strict models, checked alike when written and when read.

A number that is not finite (the age of a signal that never came, a width that could not be
found) is null in the JSON, since JSON has no other word for it.
"""

from __future__ import annotations

import json
from typing import Annotated, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from armodal.protocols.errors import JournalError

__all__ = [
    "EndModel",
    "HeaderModel",
    "HitModel",
    "LossModel",
    "MarkModel",
    "ReadingModel",
    "VerdictModel",
    "check",
    "from_json",
    "to_json",
]

MAX_JOINTS = 64
MAX_CHANNELS = 64
MAX_CODES = 64

Name = Annotated[str, Field(max_length=256, pattern=r"^[^\x00]*$")]
Sentence = Annotated[str, Field(max_length=4096, pattern=r"^[^\x00]*$")]
FileText = Annotated[str, Field(max_length=8 * 2**20, pattern=r"^[^\x00]*$")]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Index = Annotated[int, Field(ge=0, lt=2**63)]
Integer = Annotated[int, Field(ge=-(2**63), lt=2**63)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


class Strict(BaseModel):
    """No unknown keys, no conversions, no infinities."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class HeaderModel(Strict):
    """The HEADER record, without the board's dictionary."""

    session_id: Annotated[str, Field(pattern=r"^[0-9a-f]{1,64}$")]
    created: Name
    software: Name
    arm_text: FileText
    urdf_text: FileText | None
    database_text: FileText | None
    arm_sha256: Sha256
    plan_text: FileText
    plan_sha256: Sha256
    channel_mask: Annotated[int, Field(gt=0, lt=2**MAX_CHANNELS)]
    time_scale: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    told_tolerance_rad: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    measured_by: Name = ""


class ReadingModel(Strict):
    """A JointReading; `age_s` null means that nothing ever came."""

    joints_rad: Annotated[tuple[Finite, ...], Field(max_length=MAX_JOINTS)] | None
    drive_state: Integer | None
    held: bool
    age_s: Annotated[float, Field(ge=0)] | None
    host_s: Finite


class VerdictModel(Strict):
    """A Verdict; null where peak or width could not be found."""

    accepted: bool
    reasons: Annotated[tuple[Name, ...], Field(max_length=MAX_CODES)]
    notes: Annotated[tuple[Sentence, ...], Field(max_length=MAX_CODES)]
    peak_n: Finite | None
    width_s: Finite | None
    polarity: Literal[1, -1] = 1


class HitModel(Strict):
    """A HIT record, without its counts."""

    number: Annotated[int, Field(ge=1, lt=2**31)]
    posture: Name
    sensor_point: Name
    hit_point: Name
    hit_direction: tuple[Finite, Finite, Finite]
    first_sample: Index
    trigger_sample: Index
    trigger_host_s: Finite
    n_samples: Annotated[int, Field(ge=0, le=2**24)]
    n_channels: Annotated[int, Field(ge=1, le=MAX_CHANNELS)]
    before: ReadingModel
    after: ReadingModel
    verdict: VerdictModel


class LossModel(Strict):
    """A LOSS record."""

    kind: Name
    count: Index
    first_sample: Index | None
    host_s: Finite
    note: Sentence


class MarkModel(Strict):
    """A MARK record."""

    kind: Name
    posture: Name | None
    point: Name | None
    host_s: Finite
    note: Sentence
    hit: Annotated[int, Field(ge=1, lt=2**31)] | None = None


class EndModel(Strict):
    """An END record."""

    reason: Sentence
    host_s: Finite


ModelT = TypeVar("ModelT", bound=BaseModel)


def check(model: type[ModelT], values: dict[str, object], what: str) -> ModelT:
    """Return the model of `values`, or raise JournalError naming the first value refused."""
    try:
        return model.model_validate(values)
    except ValidationError as error:
        raise JournalError(_refusal(error, what)) from None


def to_json(model: BaseModel) -> bytes:
    """Return compact UTF-8 JSON; floats are written so that they read back exactly."""
    return model.model_dump_json().encode()


def from_json(model: type[ModelT], data: bytes | memoryview, what: str, limit: int) -> ModelT:
    """Read strict JSON of at most `limit` bytes, or raise JournalError in one sentence."""
    if len(data) > limit:
        raise JournalError(f"{what}: at most {limit} bytes of JSON were wanted, {len(data)} came")
    raw = bytes(data)
    try:
        read = model.model_validate_json(raw)
    except ValidationError as error:
        raise JournalError(_refusal(error, what)) from None
    try:
        json.loads(raw, object_pairs_hook=lambda pairs: _unique(pairs, what))
    except JournalError:
        raise
    except (ValueError, RecursionError) as error:
        raise JournalError(f"{what}: {str(error)[:300]}") from None
    return read


def _unique(pairs: list[tuple[str, object]], what: str) -> None:
    keys = [key for key, _ in pairs]
    if len(set(keys)) != len(keys):
        twice = next(key for key in keys if keys.count(key) > 1)
        raise JournalError(f"{what}: the key {twice!r} stands there twice")


def _refusal(error: ValidationError, what: str) -> str:
    first = error.errors(include_url=False, include_input=False, include_context=False)[0]
    path = ".".join(str(part)[:64] for part in first["loc"])
    return f"{what}: {path + ': ' if path else ''}{first['msg'][:300]}"
