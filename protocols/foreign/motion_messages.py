"""ROS and JSON messages of motion, from MCAP files and rosbags, as streams.

`mcap` reads MCAP, `rosbags` reads bags of ROS 1 and ROS 2 and decodes ROS 2 messages. Of the
messages JointState (rad), Imu and AccelStamped (m/s², both by REP 103) are read, in ROS or in JSON
with the same fields.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from armodal.protocols.apart import apart, most_bytes_beside, most_s_beside
from armodal.protocols.errors import ForeignFileError, MissingPackageError
from armodal.protocols.foreign.motion_streams import Stream

__all__ = ["prepare", "stay_within_bounds", "streams_of", "tried"]

_KINDS = ("JointState", "Imu", "AccelStamped")
_MOST_BYTES = 2**30  # of a record, unpacked

# Of a message: its topic, the time it was logged in ns, its kind, and itself.
_Message = tuple[str, int, str, Any]
# Of a message: stamp in ns, joints, frame and values.
_Row = tuple[int, tuple[str, ...], str, list[float]]


def streams_of(path: Path) -> list[Stream]:
    """Read all topics of motion.

    Raises
    ------
    MissingPackageError
        If a package that reads such files is not installed.
    ForeignFileError
        If the file cannot be read, or a message lacks a field.
    """
    messages = _of_mcap if path.suffix == ".mcap" else _of_rosbag
    rows: dict[str, list[_Row]] = {}
    try:
        for topic, logged_ns, kind, message in messages(path):
            row = _row(kind, message, logged_ns)
            if row[-1]:  # joint states without positions are of velocities or torques
                rows.setdefault(topic, []).append(row)
    except (MissingPackageError, ForeignFileError):
        raise
    except Exception as error:  # the packages raise whatever their parsers meet
        said = (str(error).splitlines() or [""])[0][:160] or type(error).__name__
        raise ForeignFileError(
            f"{path.name}: wanted an MCAP file or a rosbag, it cannot be read ({said}): cut off, "
            "damaged, or a message without these fields? Record it again"
        ) from error
    begun_ns = min((own[0][0] for own in rows.values()), default=0)
    return [_stream(path, topic, own, begun_ns) for topic, own in rows.items()]


def stay_within_bounds(path: Path) -> None:
    """Read a file in another process first: what is packed in it may be without end.

    Raises
    ------
    MissingPackageError, ForeignFileError
        As `streams_of`, or ForeignFileError if it takes more than it may.
    """
    parts = path.iterdir() if path.is_dir() else (path,)
    size = sum(part.stat().st_size for part in parts)
    apart(
        f"{__name__}:tried",
        {"path": str(path)},
        most_bytes=most_bytes_beside(size),
        most_s=most_s_beside(size),
        what=path.name,
        error=ForeignFileError,
    )


def prepare() -> None:
    """Load the packages, which take memory of their own."""
    for name in ("mcap.reader", "rosbags.highlevel", "rosbags.typesys"):
        with suppress(ImportError):
            import_module(name)


def tried(path: str) -> str:
    """Read a file as `streams_of`."""
    streams_of(Path(path))
    return ""


def _stream(path: Path, topic: str, rows: list[_Row], begun_ns: int) -> Stream:
    _, joints, frame, _ = rows[0]
    n = len(joints) or 3
    if any((own, len(values)) != (joints, n) for _, own, _, values in rows):
        raise ForeignFileError(
            f"{path.name}: wanted the same joints in every message of {topic}, got others; log the "
            "arm's joints on a topic of their own"
        )
    return Stream(
        topic=topic,
        joints=joints,
        frame=frame,
        stamp_s=np.array([1e-9 * (stamp_ns - begun_ns) for stamp_ns, *_ in rows]),
        values=np.array([values for *_, values in rows], dtype=np.float64),
    )


def _row(kind: str, message: Any, logged_ns: int) -> _Row:
    """Read a message; a stamp that was not set is when it was logged."""
    stamp = message.header.stamp
    part = stamp.nanosec if hasattr(stamp, "nanosec") else stamp.nsec
    stamp_ns = (int(stamp.sec) * 1_000_000_000 + int(part)) or logged_ns
    if kind == "JointState":
        return stamp_ns, tuple(message.name), "", [float(angle) for angle in message.position]
    found = message.linear_acceleration if kind == "Imu" else message.accel.linear
    return stamp_ns, (), str(message.header.frame_id), [found.x, found.y, found.z]


def _kind(type_name: str) -> str | None:
    last = type_name.replace(".", "/").rsplit("/", 1)[-1]
    return last if last in _KINDS else None


def _of_mcap(path: Path) -> Iterator[_Message]:
    try:
        from mcap.reader import SeekingReader  # noqa: PLC0415 - an extra of armodal
        from rosbags.typesys import (  # noqa: PLC0415 - likewise
            Stores,
            get_types_from_msg,
            get_typestore,
        )
    except ImportError as error:
        raise _missing(path, "mcap and rosbags") from error
    store = get_typestore(Stores.EMPTY)
    readers: dict[int, Callable[[bytes], Any] | None] = {}

    def reader_of(schema: Any, channel: Any) -> Callable[[bytes], Any] | None:
        kind = _kind(schema.name) if schema is not None else None
        if kind is None:
            return None
        if channel.message_encoding == "json":
            return lambda data: json.loads(data, object_hook=lambda d: SimpleNamespace(**d))
        if channel.message_encoding == "cdr" and schema.encoding == "ros2msg":
            store.register(get_types_from_msg(schema.data.decode(), schema.name))
            return lambda data: store.deserialize_cdr(data, schema.name)
        raise ForeignFileError(
            f"{path.name}: wanted messages in JSON, or in CDR with a ros2msg schema, on "
            f"{channel.topic}, got {channel.message_encoding or 'none'} with "
            f"{schema.encoding or 'no schema'}; convert the file"
        )

    with path.open("rb") as stream:
        made = SeekingReader(stream, validate_crcs=True, record_size_limit=_MOST_BYTES)
        for schema, channel, message in made.iter_messages():
            if channel.id not in readers:
                readers[channel.id] = reader_of(schema, channel)
            read = readers[channel.id]
            if read is not None and schema is not None:
                kind = _kind(schema.name) or ""
                yield channel.topic, message.log_time, kind, read(message.data)


def _of_rosbag(path: Path) -> Iterator[_Message]:
    try:
        from rosbags.highlevel import AnyReader  # noqa: PLC0415 - an extra of armodal
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - likewise
    except ImportError as error:
        raise _missing(path, "rosbags") from error
    # What a bag without message definitions means: these messages are alike in all of ROS 2.
    known = get_typestore(Stores.LATEST)
    with AnyReader([path], default_typestore=known) as reader:
        wanted = [one for one in reader.connections if _kind(one.msgtype)]
        for connection, logged_ns, data in reader.messages(wanted) if wanted else ():
            message = reader.deserialize(data, connection.msgtype)
            yield connection.topic, logged_ns, _kind(connection.msgtype) or "", message


def _missing(path: Path, package: str) -> MissingPackageError:
    return MissingPackageError(
        f"{path.name}: wanted the packages {package} to read such a log, not all are installed; "
        "install them with `pip install 'armodal[logs]'`"
    )
