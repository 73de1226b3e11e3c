"""What is remembered of sensors by their serial numbers: the sensitivity they were last used with.

A typing error in a front-end file or a board's dictionary scales every result. A sensor that was
used before with another sensitivity is told, unless it has been calibrated since. The file is
JSON, `docs/acquisition.md` says where.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from armodal.protocols.board.records import Channel
from armodal.protocols.errors import SessionError
from armodal.protocols.os_words import os_words
from armodal.protocols.teds import ALIKE

__all__ = ["KnownSensor", "load_sensors", "remember_sensors", "unlike_before"]

_LIMIT_BYTES = 1024 * 1024


class KnownSensor(BaseModel):
    """A sensor as it was last used.

    sensitivity_mv : mV per N or per m/s^2, below 0 where it inverts
    calibration_date : ISO 8601, or empty
    used : ISO 8601 date
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    sensitivity_mv: Annotated[float, Field(allow_inf_nan=False)]
    calibration_date: str
    used: str


class _Memory(BaseModel):
    model_config = ConfigDict(extra="forbid")

    format: Literal["armodal-sensors-1"] = "armodal-sensors-1"
    sensors: dict[str, KnownSensor] = {}


def _key(channel: Channel) -> str:
    """Serial number and axis, for three axes have one number; empty where there is no number."""
    number = channel.serial_number
    return f"{channel.quantity} {number} {channel.name}" if number else ""


def _sensitivity_mv(channel: Channel, range_v: float) -> float:
    return math.copysign(1e3 * range_v / channel.full_scale, channel.scale)


def load_sensors(path: Path) -> dict[str, KnownSensor]:
    """Read what is remembered; nothing where there is no file.

    Raises
    ------
    SessionError
        If the file is not one of these.
    """
    try:
        if path.stat().st_size > _LIMIT_BYTES:
            raise SessionError(f"{path}: wanted at most {_LIMIT_BYTES} bytes; delete the file")
        return _Memory.model_validate_json(path.read_bytes()).sensors
    except FileNotFoundError:
        return {}
    except (OSError, ValidationError) as error:
        raise SessionError(
            f"{path}: wanted what is remembered of sensors, it cannot be read; delete the file, "
            "and sensitivities are remembered anew"
        ) from error


def unlike_before(
    channels: Iterable[Channel], range_v: float | None, known: Mapping[str, KnownSensor]
) -> list[str]:
    """Sentences on sensors that have another sensitivity than when they were last used.

    Parameters
    ----------
    channels
        As they are described now.
    range_v
        Largest input voltage; without it nothing can be compared.
    known
        What is remembered.
    """
    if range_v is None:
        return []
    said = []
    for channel in channels:
        before = known.get(_key(channel))
        if before is None or channel.calibration_date > before.calibration_date:
            continue
        now_mv = _sensitivity_mv(channel, range_v)
        if abs(now_mv - before.sensitivity_mv) > ALIKE * abs(before.sensitivity_mv):
            said.append(
                f"{channel.name}: {now_mv:.4g} mV per {channel.unit}, and sensor "
                f"{channel.serial_number} had {before.sensitivity_mv:.4g} when it was last used, "
                f"on {before.used}"
            )
    return said


def remember_sensors(
    path: Path, channels: Iterable[Channel], range_v: float | None, today: str
) -> None:
    """Remember sensors as they are used; those without a serial number are not.

    Raises
    ------
    SessionError
        If the file cannot be read or written.
    """
    found = {_key(channel): channel for channel in channels if _key(channel)}
    if range_v is None or not found:
        return
    known = load_sensors(path) | {
        key: KnownSensor(
            sensitivity_mv=_sensitivity_mv(channel, range_v),
            calibration_date=channel.calibration_date,
            used=today,
        )
        for key, channel in found.items()
    }
    made = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        made.write_text(_Memory(sensors=known).model_dump_json(indent=1), encoding="utf-8")
        made.replace(path)
    except OSError as error:
        raise SessionError(
            f"{path}: what is remembered of sensors cannot be written ({os_words(error)}); check "
            "rights and free space"
        ) from error
