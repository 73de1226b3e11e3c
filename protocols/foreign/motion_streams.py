"""A log of motion out of streams of stamped messages, each with a rate of its own.

Drivers sample evenly and stamp with what their clock shows, early or late by a part of a step. So
a stream's samples are taken as even on the straight line through their stamps, and all streams are
brought to the rate of the fastest by curves of fifth order, whose second derivative is smooth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.motion_log import FEWEST_ROWS, MotionLog, check_motion

__all__ = ["COMMAND", "ENCODER", "Stream", "log_of_streams"]

Array = npt.NDArray[np.float64]

ENCODER, COMMAND = "encoder", "command"
_COMMANDED = ("command", "cmd", "desired", "reference", "target", "setpoint")
_LOST = 0.5  # of a step: beyond it a sample is missing, twice there, or the clock was set
_TOLD = 0.1  # of a step: as far off its line a stamp may be unmentioned


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """The messages of one topic."""

    topic: str
    joints: tuple[str, ...]  # whose angles in rad they are; empty: an accelerometer, m/s^2
    frame: str  # of an accelerometer
    stamp_s: Array  # (n,)
    values: Array  # (n, n_joints or 3)

    @property
    def step_s(self) -> float:
        """Return what most stamps are apart."""
        return float(np.median(np.diff(self.stamp_s)))


def log_of_streams(
    streams: Sequence[Stream], origin: str, arm: Arm, roles: Mapping[str, str]
) -> MotionLog:
    """Return the log of an arm.

    Parameters
    ----------
    roles
        Topics by `encoder`, `command` or a test point; what is not named is found by its name.

    Raises
    ------
    ForeignFileError
        If joints, angles or accelerometers are missing, a topic could be several things, or a
        clock is not even; all faults of a kind at once.
    """
    angles, sensors = _chosen(streams, origin, arm, roles)
    used = [*angles.values(), *sensors.values()]
    notes = [note for stream in used for note in _checked_clock(stream, used, origin)]
    lines = {stream.topic: np.polyfit(*_counted(stream), 1)[::-1] for stream in used}
    rates = [1.0 / float(lines[stream.topic][1]) for stream in used]
    first = max(float(lines[stream.topic][0]) for stream in used)
    last = min(float(lines[s.topic][0] + lines[s.topic][1] * (len(s.stamp_s) - 1)) for s in used)
    count = int((last - first) * max(rates)) + 1
    if count < FEWEST_ROWS:
        raise ForeignFileError(
            f"{origin}: wanted at least {FEWEST_ROWS} rows of the fastest topic while all others "
            f"were logged too, got {max(count, 0)}; log all at the same time"
        )
    grid = first + np.arange(count) / max(rates)
    found = {stream.topic: _at(grid, stream, lines[stream.topic]) for stream in used}
    names = [joint.name for joint in arm.joints]
    joints = {
        role: found[s.topic][:, [s.joints.index(name) for name in names]]
        for role, s in angles.items()
    }
    log = MotionLog(
        rate_hz=max(rates),
        slowest_hz=min(rates),
        encoder_rad=joints.get(ENCODER),
        command_rad=joints.get(COMMAND),
        acceleration_m_s2={point: found[stream.topic] for point, stream in sensors.items()},
        unused=tuple(s.topic for s in streams if s.topic not in found),
        notes=tuple(notes),
    )
    return check_motion(log, origin, arm)


def _chosen(
    streams: Sequence[Stream], origin: str, arm: Arm, roles: Mapping[str, str]
) -> tuple[dict[str, Stream], dict[str, Stream]]:
    by_topic = {stream.topic: stream for stream in streams}
    points = {point.id for point in arm.points}
    faults = [f"a topic {t} for {r}" for r, t in roles.items() if t not in by_topic]
    faults += [
        f"'{ENCODER}', '{COMMAND}' or a test point of the arm before a topic, not '{role}'"
        for role in roles
        if role not in points and role not in (ENCODER, COMMAND)
    ]
    candidates: dict[str, list[Stream]] = {}
    for stream in streams:
        role = _role(stream, arm)
        if role is not None and role not in roles and stream.topic not in roles.values():
            candidates.setdefault(role, []).append(stream)
    candidates |= {r: [by_topic[t]] for r, t in roles.items() if t in by_topic}
    faults += [
        f"one topic for {role}, not {' and '.join(s.topic for s in several)} "
        f"(say which by --topic {role}=TOPIC)"
        for role, several in candidates.items()
        if len(several) > 1
    ]
    chosen = {role: several[0] for role, several in candidates.items()}
    angles = {role: chosen[role] for role in (ENCODER, COMMAND) if role in chosen}
    sensors = {role: stream for role, stream in chosen.items() if role in points}
    for role, stream in angles.items():
        lacking = [joint.name for joint in arm.joints if joint.name not in stream.joints]
        if lacking:
            faults.append(f"the joints {', '.join(lacking)} in {stream.topic} for {role}")
    faults += [
        f"accelerations in {stream.topic} for point {point}"
        for point, stream in sensors.items()
        if stream.joints
    ]
    if not angles:
        faults.append("JointState messages with the angles of all joints")
    if not sensors:
        faults.append(
            "Imu or AccelStamped messages whose topic ends in, or whose frame_id is, a test point "
            "of the arm as POINT or acc_POINT (or --topic POINT=TOPIC)"
        )
    if faults:
        seen = ", ".join(f"{s.topic} ({'joints' if s.joints else s.frame or '-'})" for s in streams)
        raise ForeignFileError(f"{origin}: wanted {'; '.join(faults)}; got {seen or 'no such'}")
    return angles, sensors


def _role(stream: Stream, arm: Arm) -> str | None:
    """What a topic is by its name."""
    if stream.joints:
        if not {joint.name for joint in arm.joints} <= set(stream.joints):
            return None
        said = stream.topic.lower()
        return COMMAND if any(word in said for word in _COMMANDED) else ENCODER
    names = {stream.topic.rsplit("/", 1)[-1], stream.frame}
    return next((p.id for p in arm.points if names & {p.id, f"acc_{p.id}"}), None)


def _checked_clock(stream: Stream, used: Sequence[Stream], origin: str) -> list[str]:
    """Notes on a clock that can be used.

    Raises
    ------
    ForeignFileError
        If one of `used` cannot; all are named.
    """
    faults = [fault for one in used for fault in _clock_faults(one)]
    if faults:
        raise ForeignFileError(
            f"{origin}: wanted {'; '.join(faults)}; log anew, or cut the file to a part without"
        )
    count, stamps = _counted(stream)
    off = np.abs(stamps - np.polyval(np.polyfit(count, stamps, 1), count)).max() / stream.step_s
    if off <= _TOLD:
        return []
    said = (
        f"stamps of {stream.topic} are up to {off:.2f} of a step off an even clock; its samples "
        "were taken as even"
    )
    return [said]


def _clock_faults(stream: Stream) -> list[str]:
    if len(stream.stamp_s) < FEWEST_ROWS:
        return [f"at least {FEWEST_ROWS} messages on {stream.topic}, got {len(stream.stamp_s)}"]
    if not np.isfinite(stream.values).all():
        row = int(np.flatnonzero(~np.isfinite(stream.values).all(axis=1))[0])
        return [f"finite numbers on {stream.topic}, got others in message {row + 1}"]
    step = stream.step_s
    if step <= 0.0:
        return [f"stamps that grow on {stream.topic}"]
    jumps = np.flatnonzero(np.abs(np.diff(stream.stamp_s) - step) > _LOST * step)
    if not jumps.size:
        return []
    at = int(jumps[0])
    seen = stream.stamp_s[at + 1] - stream.stamp_s[at]
    said = (
        f"stamps {1e3 * step:.4g} ms apart on {stream.topic} as most are, got {1e3 * seen:.4g} ms "
        f"after message {at + 1} and {len(jumps)} such steps in all: a jump of the clock, or "
        "messages that were lost"
    )
    return [said]


def _counted(stream: Stream) -> tuple[Array, Array]:
    return np.arange(len(stream.stamp_s), dtype=np.float64), stream.stamp_s


def _at(grid: Array, stream: Stream, line: Array) -> Array:
    own = line[0] + line[1] * np.arange(len(stream.values))
    curve = scipy.interpolate.make_interp_spline(own, stream.values, k=5)
    return np.asarray(curve(np.clip(grid, own[0], own[-1])))
