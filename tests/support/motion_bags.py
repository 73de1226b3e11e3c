"""Logs of motion in ROS and in JSON, written by the packages that define them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

# A topic: its name, whether joints (with names) or a frame, stamps in ns, values a row a message.
Topic = tuple[str, Sequence[str] | str, np.ndarray, np.ndarray]


def _messages(store: Any, topics: Sequence[Topic], ros: int) -> Iterator[tuple[str, int, Any]]:
    types = store.types
    Header, Time = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    Vector, Quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]
    empty, nine = np.zeros(0), np.zeros(9)
    for topic, of, stamps, values in topics:
        for stamp, row in zip(stamps.tolist(), values, strict=True):
            time = Time(sec=stamp // 10**9, nanosec=stamp % 10**9)
            more = {"seq": 0} if ros == 1 else {}
            if isinstance(of, str):
                message = types["sensor_msgs/msg/Imu"](
                    header=Header(stamp=time, frame_id=of, **more),
                    orientation=Quaternion(x=0.0, y=0.0, z=0.0, w=1.0),
                    orientation_covariance=nine,
                    angular_velocity=Vector(x=0.0, y=0.0, z=0.0),
                    angular_velocity_covariance=nine,
                    linear_acceleration=Vector(x=row[0], y=row[1], z=row[2]),
                    linear_acceleration_covariance=nine,
                )
            else:
                message = types["sensor_msgs/msg/JointState"](
                    header=Header(stamp=time, frame_id="", **more),
                    name=list(of),
                    position=np.asarray(row),
                    velocity=empty,
                    effort=empty,
                )
            yield topic, stamp, message


def rosbag1(path: Path, topics: Sequence[Topic]) -> Path:
    from rosbags.rosbag1 import Writer  # noqa: PLC0415 - an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra

    store = get_typestore(Stores.ROS1_NOETIC)
    path = path.with_suffix(".bag")
    with Writer(path) as bag:
        found: dict[str, Any] = {}
        for topic, stamp, message in _messages(store, topics, 1):
            kind = message.__msgtype__
            if topic not in found:
                found[topic] = bag.add_connection(topic, kind, typestore=store)
            bag.write(found[topic], stamp, store.serialize_ros1(message, kind))
    return path


def rosbag2(path: Path, topics: Sequence[Topic]) -> Path:
    from rosbags.rosbag2 import StoragePlugin, Writer  # noqa: PLC0415 - an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(path, version=8, storage_plugin=StoragePlugin.SQLITE3) as bag:
        found: dict[str, Any] = {}
        for topic, stamp, message in _messages(store, topics, 2):
            kind = message.__msgtype__
            if topic not in found:
                found[topic] = bag.add_connection(topic, kind, typestore=store)
            bag.write(found[topic], stamp, store.serialize_cdr(message, kind))
    return path


def mcap_cdr(path: Path, topics: Sequence[Topic]) -> Path:
    from mcap.writer import Writer  # noqa: PLC0415 - an extra
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra

    store = get_typestore(Stores.ROS2_HUMBLE)
    path = path.with_suffix(".mcap")
    with path.open("wb") as stream:
        file = Writer(stream)
        file.start(profile="ros2")
        found: dict[str, int] = {}
        for topic, stamp, message in _messages(store, topics, 2):
            kind = message.__msgtype__
            if topic not in found:
                text = store.generate_msgdef(kind, ros_version=2)[0]
                schema = file.register_schema(kind, "ros2msg", text.encode())
                found[topic] = file.register_channel(topic, "cdr", schema)
            data = bytes(store.serialize_cdr(message, kind))
            file.add_message(found[topic], stamp, data, stamp)
        file.finish()
    return path


def mcap_json(path: Path, topics: Sequence[Topic]) -> Path:
    from mcap.writer import Writer  # noqa: PLC0415 - an extra

    path = path.with_suffix(".mcap")
    with path.open("wb") as stream:
        file = Writer(stream)
        file.start()
        for topic, of, stamps, values in topics:
            kind = "Imu" if isinstance(of, str) else "JointState"
            schema = file.register_schema(f"sensor_msgs/{kind}", "jsonschema", b"{}")
            channel = file.register_channel(topic, "json", schema)
            for stamp, row in zip(stamps.tolist(), values.tolist(), strict=True):
                header = {"stamp": {"sec": stamp // 10**9, "nsec": stamp % 10**9}}
                if isinstance(of, str):
                    message = {
                        "header": header | {"frame_id": of},
                        "linear_acceleration": dict(zip("xyz", row, strict=True)),
                    }
                else:
                    message = {"header": header, "name": list(of), "position": row}
                file.add_message(channel, stamp, json.dumps(message).encode(), stamp)
        file.finish()
    return path


WRITERS: dict[str, Callable[[Path, Sequence[Topic]], Path]] = {
    "rosbag 1": rosbag1,
    "rosbag 2": rosbag2,
    "MCAP with CDR": mcap_cdr,
    "MCAP with JSON": mcap_json,
}
