"""Where joint angles are in the messages of an MQTT broker: the file, and a message read by it.

The format is specified in `docs/acquisition.md`. A message is JSON; a place in it is written as
keys and places of lists with dots between, as `state.joints.0`.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from armodal.protocols.errors import ControllerError
from armodal.protocols.joint_sample import JointSample
from armodal.protocols.toml_reader import FileModel, parse_toml, read_text, validate

__all__ = ["MqttJoints", "load_mqtt_joints", "mqtt_joints_from_text"]

_LIMIT = 64 * 1024
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

Place = Annotated[str, Field(pattern=r"^[^.\s]+(\.[^.\s]+)*$", max_length=256)]


class MqttJoints(FileModel):
    """What the file says.

    broker : HOST or HOST:PORT
    joints : place of a list of all angles, base first, or the places of each
    time, time_unit : place of the sender's clock; without it nothing tells of messages left out
    held, held_values : place of the drives' state, and what it is while they hold the arm
    """

    format: Literal["armodal-mqtt-1"]
    broker: Annotated[str, Field(pattern=r"^[^\s:]+(:[0-9]{1,5})?$")]
    topic: Annotated[str, Field(pattern=r"^[^+#\s]+$", max_length=256)]
    joints: Place | Annotated[list[Place], Field(min_length=1, max_length=32)]
    unit: Literal["rad", "deg"]
    rate_hz: Annotated[float, Field(gt=0.0, le=1000.0)]
    time: Place | None = None
    time_unit: Literal["s", "ms", "us", "ns"] = "s"
    held: Place | None = None
    held_values: list[int | str | bool] = Field(default_factory=list)

    def sample(self, message: bytes, n_joints: int) -> JointSample | None:
        """Return what a message tells; None where it lacks anything or holds something else."""
        try:
            told = json.loads(message)
        except (ValueError, RecursionError):
            return None
        if isinstance(self.joints, str):
            angles = _at(told, self.joints)
        else:
            angles = [_at(told, place) for place in self.joints]
        if not isinstance(angles, list) or len(angles) != n_joints or not all(map(_number, angles)):
            return None
        stamp = None if self.time is None else _at(told, self.time)
        if self.time is not None and not _number(stamp):
            return None
        state = None if self.held is None else _at(told, self.held)
        if self.held is not None and not isinstance(state, int | str | bool):
            return None
        return JointSample(
            timestamp_s=None if stamp is None else float(stamp) * _SECONDS[self.time_unit],
            joints_rad=tuple(float(math.radians(a) if self.unit == "deg" else a) for a in angles),
            drive_state=int(state) if isinstance(state, int) else None,
            held=self.held is None or any(_same(state, value) for value in self.held_values),
        )


def load_mqtt_joints(path: Path) -> MqttJoints:
    """Read a file; ControllerError, with the key's path, where a value is not possible."""
    text = read_text(path, what="MQTT file", limit_bytes=_LIMIT, error=ControllerError)
    return mqtt_joints_from_text(text, origin=f"MQTT file {path.name}")


def mqtt_joints_from_text(text: str, *, origin: str) -> MqttJoints:
    """Return what the text of a file says, or raise ControllerError."""
    data = parse_toml(text, origin=origin, error=ControllerError)
    found = validate(MqttJoints, data, origin=origin, error=ControllerError)
    if (found.held is None) != (not found.held_values):
        raise ControllerError(
            f"{origin}: wanted held with held_values, or neither, got one of them: held is the "
            "place of the drives' state, held_values what it is while they hold the arm"
        )
    return found


def _at(told: Any, place: str) -> Any:
    """What stands at a place; None where nothing does."""
    for key in place.split("."):
        if isinstance(told, dict):
            told = told.get(key)
        elif isinstance(told, list) and key.isdecimal() and int(key) < len(told):
            told = told[int(key)]
        else:
            return None
    return told


def _number(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and abs(value) < 1e30 and math.isfinite(value)


def _same(state: Any, value: Any) -> bool:
    return type(state) is type(value) and state == value
