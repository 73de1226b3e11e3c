"""Logs of motion of any kind that is read: CSV, MCAP, rosbags."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.motion_csv import read_motion_csv
from armodal.protocols.foreign.motion_log import MotionLog
from armodal.protocols.foreign.motion_messages import stay_within_bounds, streams_of
from armodal.protocols.foreign.motion_streams import log_of_streams

__all__ = ["read_motion_log"]

_BAGS = (".mcap", ".bag", ".db3")


def read_motion_log(path: Path, arm: Arm, roles: Mapping[str, str] | None = None) -> MotionLog:
    """Read a log of an arm's motion; by its name it is MCAP, a rosbag, or CSV.

    Parameters
    ----------
    roles
        Of MCAP files and rosbags: topics by `encoder`, `command` or a test point. Of an RTDE table:
        `actual_tool_accelerometer` by a test point.

    Raises
    ------
    MissingPackageError
        If MCAP or rosbags are to be read and their packages are not installed.
    ForeignFileError
        If it cannot be read, something is missing, a clock is not even or a joint is where it
        cannot be; all faults of a kind at once.
    """
    if path.suffix in _BAGS or path.is_dir():
        if not path.exists():
            raise ForeignFileError(f"{path}: wanted a log of motion, found no such file")
        stay_within_bounds(path)
        return log_of_streams(streams_of(path), path.name, arm, roles or {})
    return read_motion_csv(path, arm, roles)
