"""A log of motion as CSV.

    time_s, JOINT_command_deg, JOINT_encoder_deg, ..., acc_POINT_x_m_s2, _y_, _z_, ...

Every joint has an encoder or a command column, or both; the unit is in the name. Tables that
Universal Robots' RTDE client records have names and units of their own (`motion_rtde`).
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm
from armodal.protocols.bounds import most_decoded_bytes
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.motion_log import FEWEST_ROWS, MotionLog, check_motion
from armodal.protocols.foreign.motion_rtde import TOOL_ACCELEROMETER, is_rtde, rtde_columns
from armodal.protocols.toml_reader import read_text

__all__ = ["read_motion_csv"]

Array = npt.NDArray[np.float64]

_EVEN = 0.1  # of a period that a time may be off: the angles are differentiated twice
_LIMIT = 500_000_000  # bytes
_SHOWN = 24  # columns that are told of a faulty table
_MOST_COLUMNS = 4096
_MOST_BAD = 10_000  # rows, after which no more are looked for
_AT_ONCE = 2**20  # characters whose numbers are read together
_NAMED = 5  # faults of one kind that are told by row


def read_motion_csv(path: Path, arm: Arm, roles: Mapping[str, str] | None = None) -> MotionLog:
    """Read a log of an arm's motion.

    Parameters
    ----------
    roles
        Of an RTDE table: the test point that `actual_tool_accelerometer` is at.

    Raises
    ------
    ForeignFileError
        If it cannot be read, a column is missing, a value is no number, its time is not
        even, or a joint is where it cannot be; all faults of the columns, or of the rows, at once.
    """
    text = read_text(path, what="log of motion", limit_bytes=_LIMIT, error=ForeignFileError)
    head, _, _ = text.partition("\n")
    spaced = "," not in head
    names = _names(path, head, spaced=spaced)
    scale = [1.0] * len(names)
    rtde = is_rtde(names)
    _check_roles(path, roles or {}, rtde=rtde)
    if rtde:
        names, scale = rtde_columns(names, arm, roles or {})
    _check_columns(path, names, arm, rtde=rtde)
    values = _values(path, names, text, None if spaced else ",")
    values *= scale
    column = dict(zip(names, values.T, strict=True))
    time = column["time_s"]
    step = float(np.median(np.diff(time)))
    used = {"time_s"}

    def of_joints(kind: str) -> Array | None:
        wanted = [f"{joint.name}_{kind}_deg" for joint in arm.joints]
        if not set(wanted) <= set(names):
            return None
        used.update(wanted)
        return np.asarray(np.deg2rad(np.stack([column[name] for name in wanted], axis=1)))

    encoder, command = of_joints("encoder"), of_joints("command")
    acceleration = {}
    for point in arm.points:
        own = _of_point(point.id)
        if set(own) <= set(names):
            used.update(own)
            acceleration[point.id] = np.stack([column[name] for name in own], axis=1)
    log = MotionLog(
        rate_hz=1.0 / step,
        slowest_hz=1.0 / step,
        encoder_rad=encoder,
        command_rad=command,
        acceleration_m_s2=acceleration,
        unused=tuple(name for name in names if name not in used),
    )
    return check_motion(log, path.name, arm)


def _of_point(point: str) -> list[str]:
    return [f"acc_{point}_{axis}_m_s2" for axis in "xyz"]


def _check_roles(path: Path, roles: Mapping[str, str], *, rtde: bool) -> None:
    others = [f"{role}={topic}" for role, topic in roles.items() if topic != TOOL_ACCELEROMETER]
    if (roles and not rtde) or others:
        raise ForeignFileError(
            f"{path.name}: wanted --topic with an MCAP file or a rosbag, or as "
            f"POINT={TOOL_ACCELEROMETER} with an RTDE table, got it with a CSV log"
            f"{': ' + ', '.join(others) if others else ''}"
        )


def _check_columns(path: Path, names: list[str], arm: Arm, *, rtde: bool) -> None:
    faults = []
    twice = sorted(name for name, n in Counter(names).items() if n > 1)
    if twice:
        faults.append(f"each column once, got {', '.join(twice)} again")
    if "time_s" not in names:
        faults.append("a column time_s")
    lacking = {
        kind: [own for j in arm.joints if (own := f"{j.name}_{kind}_deg") not in names]
        for kind in ("encoder", "command")
    }
    if all(lacking.values()):
        least = min(lacking.values(), key=len)
        faults.append(f"angles of all joints, without {', '.join(least)}")
    if not any(set(_of_point(point.id)) <= set(names) for point in arm.points):
        faults.append(
            f"the tool's accelerometer and the test point that it is at, --topic "
            f"POINT={TOOL_ACCELEROMETER}"
            if rtde
            else "an accelerometer at a test point of the arm, as acc_POINT_x_m_s2, "
            "acc_POINT_y_m_s2, acc_POINT_z_m_s2"
        )
    if faults:
        more = len(names) - _SHOWN
        seen = f"{', '.join(names[:_SHOWN]) or 'none'}{f' and {more} more' if more > 0 else ''}"
        raise ForeignFileError(
            f"{path.name}: wanted {'; '.join(faults)}; got the columns {seen}; name them so, with "
            "these units"
        )


def _names(path: Path, head: str, *, spaced: bool) -> list[str]:
    try:
        row = head.split() if spaced else next(csv.reader([head]))
    except csv.Error:  # a name that is longer than any
        row = []
    if len(row) > _MOST_COLUMNS:
        raise ForeignFileError(
            f"{path.name}: wanted at most {_MOST_COLUMNS} columns, got {len(row)}; log the joints "
            "and accelerometers alone"
        )
    return [name.strip() for name in row]


def _values(path: Path, names: list[str], text: str, delimiter: str | None) -> Array:
    """Return what stands below the names, (n_rows, n_columns)."""
    most = most_decoded_bytes(len(text)) // (2 * 8)  # they are held twice for a while
    rows = text.count("\n")
    if rows * len(names) > most:
        raise ForeignFileError(
            f"{path.name}: wanted at most {most} numbers, got {rows} lines of {len(names)}; cut "
            "the file to the part that is wanted"
        )
    values = np.full((rows, len(names)), np.nan)
    bad: list[int] = []
    n, at = 0, text.find("\n") + 1 or len(text)
    while at < len(text):
        end = text.find("\n", at + _AT_ONCE) + 1 or len(text)
        lines = [line for line in text[at:end].split("\n") if line.strip()]
        at = end
        if not lines:
            continue
        values[n : n + len(lines)] = _numbers(lines, len(names), delimiter)
        finite = np.isfinite(values[n : n + len(lines)]).all(axis=1)
        bad += (n + 2 + np.flatnonzero(~finite)[:_MOST_BAD]).tolist()
        n += len(lines)
        if len(bad) >= _MOST_BAD:
            break
    _check_rows(path, names, values[:n], bad)
    return values[:n]


def _numbers(lines: list[str], n: int, delimiter: str | None) -> Array:
    """Return the numbers of some lines; a line with others, or that are none, is not a number."""
    try:
        found = np.loadtxt(lines, delimiter=delimiter, ndmin=2, quotechar='"', comments=None)
    except ValueError:
        found = np.empty((0, 0))
    if found.shape == (len(lines), n):
        return found
    values = np.full((len(lines), n), np.nan)
    for number, line in enumerate(lines):
        with suppress(ValueError, csv.Error):  # another number of values, or one that is none
            row = line.split() if delimiter is None else next(csv.reader([line]))
            values[number] = [float(value) for value in row] if len(row) == n else np.nan
    return values


def _check_rows(path: Path, names: list[str], values: Array, bad: list[int]) -> None:
    faults = []
    if len(values) < FEWEST_ROWS and len(bad) < _MOST_BAD:
        faults.append(f"at least {FEWEST_ROWS} rows, got {len(values)}")
    if bad:
        faults.append(f"{len(names)} finite numbers in every row, got others in {_lines(bad)}")
    elif len(values) > 1:
        steps = np.diff(values[:, names.index("time_s")])
        step = float(np.median(steps))
        jumps = np.flatnonzero(np.abs(steps - step) > _EVEN * abs(step)) + 3
        if step <= 0.0:
            faults.append("a time_s that grows")
        elif jumps.size:
            faults.append(
                f"times {1e3 * step:.4g} ms apart as most are, got others in "
                f"{_lines(jumps.tolist())}: a jump of the clock, or rows that were lost"
            )
    if faults:
        raise ForeignFileError(
            f"{path.name}: wanted {'; '.join(faults)}; log anew, or cut the file to a part without"
        )


def _lines(numbers: list[int]) -> str:
    told = ", ".join(str(number) for number in numbers[:_NAMED])
    more = len(numbers) - _NAMED
    return f"line{'s' if len(numbers) > 1 else ''} {told}" + (
        f" and {more} more" if more > 0 else ""
    )
