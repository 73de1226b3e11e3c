"""Joint angles that a controller publishes to an MQTT broker, subscribed to and never published.

The package paho-mqtt makes the connection. Its client is not kept on this object: only its reading
half is, and what it could publish with is replaced by an error.
"""

from __future__ import annotations

import importlib
import select
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from armodal.daq.controller import ControllerOption
from armodal.daq.joint_source import MeasuredAngles
from armodal.daq.timed_joints import TimedJoints
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import (
    ControllerError,
    DeviceLostError,
    DeviceTimeoutError,
    MissingPackageError,
)
from armodal.protocols.mqtt_joints import MqttJoints, load_mqtt_joints
from armodal.protocols.os_words import os_words

__all__ = ["OPTION", "MqttController", "MqttSource", "mqtt_package"]

PORT = 1883
ANSWER_WALL_S = 3.0
KEEP_ALIVE_S = 20  # the broker is asked whether it lives
CYCLES_STALE = 4
STALE_AFTER_S = 0.1  # at least, as of every controller
MOST_WAITING = 4096


def mqtt_package() -> Any:
    """Return paho.mqtt.client, or raise MissingPackageError saying how to get it."""
    try:
        return importlib.import_module("paho.mqtt.client")
    except ImportError as error:
        raise MissingPackageError(
            "wanted the package paho-mqtt for joint angles by MQTT, it is not installed; install "
            "it with `pip install 'armodal[mqtt]'`"
        ) from error


class MqttSource(MeasuredAngles):
    """A topic of a broker that tells joint angles.

    Parameters
    ----------
    wanted
        Broker and topic, and where the angles are in its messages.
    names
        Of the arm's joints, base first.

    Raises
    ------
    MissingPackageError, ControllerError, DeviceTimeoutError
        If the package is not there, the broker cannot be reached, or refuses.
    """

    def __init__(self, wanted: MqttJoints, names: Sequence[str]) -> None:
        paho = mqtt_package()
        host, _, port = wanted.broker.partition(":")
        self.name = f"{wanted.topic} at {wanted.broker}"
        self.joints = TimedJoints(
            names,
            rate_hz=wanted.rate_hz,
            stale_after_s=max(STALE_AFTER_S, CYCLES_STALE / wanted.rate_hz),
        )
        self._wanted, self._n_joints = wanted, len(names)
        self._came: deque[bytes] = deque(maxlen=MOST_WAITING)
        self._fetched: list[tuple[float, bytes]] = []
        self._refusal: str | None = None
        self._subscribed = False
        client = paho.Client(paho.CallbackAPIVersion.VERSION2, protocol=paho.MQTTv311)
        client.publish = _never
        client.on_connect, client.on_subscribe = self._connected, self._granted
        client.on_message = self._take
        try:
            self._connect(client, host, int(port) if port else PORT)
        except BaseException:
            client.disconnect()
            raise
        self._fd: int = client.socket().fileno()
        self._read, self._look_after, self._close = (
            client.loop_read,
            client.loop_misc,
            client.disconnect,
        )

    @property
    def faults(self) -> int:
        """What came and could not be read."""
        return self.joints.invalid

    def fileno(self) -> int:
        """Return the connection's descriptor."""
        return self._fd

    def collect(self, now_s: float) -> None:
        """Fetch the messages that have come."""
        gone = self._look_after()
        # The package reads one packet at a time, and a controller may send many in a turn.
        for _ in range(MOST_WAITING):
            if gone or not select.select([self._fd], [], [], 0.0)[0]:
                break
            gone = self._read()
        if gone:
            raise DeviceLostError(
                f"the MQTT broker {self._wanted.broker} is gone; check it and its network, then "
                "resume"
            )
        while self._came:
            self._fetched.append((now_s, self._came.popleft()))

    def hear(self) -> None:
        """Read the messages fetched."""
        fetched, self._fetched = self._fetched, []
        for at_s, message in fetched:
            self.joints.take(self._wanted.sample(message, self._n_joints), at_s)

    def silence(self) -> str:
        """Say what is missing, and what may be the reason."""
        if self.joints.invalid:
            return (
                f"{self.joints.invalid} messages came on {self.name}, none with {self._n_joints} "
                "angles where the MQTT file says they are: compare it with a message"
            )
        return (
            f"no message came on {self.name}: does the controller publish, and is the topic its? "
            "A message that the broker had kept is not believed"
        )

    def close(self) -> None:
        """Take leave of the broker."""
        self._close()

    def _connect(self, client: Any, host: str, port: int) -> None:
        try:
            client.connect(host, port, KEEP_ALIVE_S)
        except TimeoutError as error:
            raise DeviceTimeoutError(
                f"nothing answers at {host}:{port}: is the MQTT broker on, and this computer on "
                "its network?"
            ) from error
        except (OSError, UnicodeError, ValueError) as error:
            said = os_words(error) if isinstance(error, OSError) else "no such address"
            raise ControllerError(
                f"the MQTT broker {host}:{port} cannot be reached ({said}): check its address in "
                "the MQTT file, and that it runs"
            ) from error
        until_s = time.monotonic() + ANSWER_WALL_S
        while not self._subscribed and self._refusal is None:
            left_s = until_s - time.monotonic()
            ended = left_s <= 0.0 or client.loop(left_s)
            if ended and self._refusal is None:
                raise DeviceTimeoutError(
                    f"what listens at {host}:{port} does not answer as an MQTT broker in "
                    f"{ANSWER_WALL_S:g} s: check the port in the MQTT file; 1883 is usual"
                )
        if self._refusal is not None:
            raise ControllerError(
                f"the MQTT broker {host}:{port} refuses ({self._refusal}): let it allow readers "
                f"without a name for {self._wanted.topic}"
            )

    def _connected(self, client: Any, _data: Any, _flags: Any, reason: Any, _more: Any) -> None:
        if reason.is_failure:
            self._refusal = str(reason).lower()
        else:
            client.subscribe(self._wanted.topic, qos=0)

    def _granted(
        self, _client: Any, _data: Any, _number: int, reasons: Sequence[Any], _more: Any
    ) -> None:
        if any(reason.is_failure for reason in reasons):
            self._refusal = f"no subscription to {self._wanted.topic}"
        self._subscribed = True

    def _take(self, _client: Any, _data: Any, message: Any) -> None:
        if not message.retain:  # kept by the broker, nobody knows since when
            self._came.append(bytes(message.payload))


def _never(*_anything: Any, **_named: Any) -> None:
    raise AssertionError("this program publishes nothing")  # pragma: no cover - nobody calls it


@dataclass(frozen=True, slots=True, kw_only=True)
class MqttController:
    """A controller that publishes to a broker."""

    wanted: MqttJoints

    @property
    def address(self) -> str:
        """The broker."""
        return self.wanted.broker

    def open(self, arm: Arm) -> MqttSource:
        """Subscribe to the topic of its angles."""
        return MqttSource(self.wanted, [joint.name for joint in arm.joints])


OPTION = ControllerOption(
    metavar="FILE",
    help="joint angles from an MQTT broker, by a file that says where.",
    controller=lambda given: MqttController(wanted=load_mqtt_joints(Path(given))),
    package=mqtt_package,
)
