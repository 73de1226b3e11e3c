"""A while of the controller's bus as it came, with everything that was decoded of it."""

from __future__ import annotations

import itertools
import select
from collections import Counter
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.daq.can_listener import CanSource
from armodal.daq.clock import Clock
from armodal.protocols.arm.records import Arm, CanMapping
from armodal.protocols.arrays import frozen_array
from armodal.protocols.can_database import CanDecoder, CanUpdate
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import ArmError, CanError

__all__ = ["CanRecording", "Message", "listen", "mapping_of"]

ASK_S = 0.5
POLL_S = 0.002  # lab seconds, for interfaces that cannot be waited on


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """One mapped message: when it came and what it said."""

    name: str
    arrivals_s: npt.NDArray[np.float64]  # (n,) lab time
    updates: tuple[CanUpdate, ...]
    refused: tuple[str, ...]  # why frames of it could not be decoded


@dataclass(frozen=True, slots=True, kw_only=True)
class CanRecording:
    """What was heard.

    `latency_s` is how late an arrival may be noted by an unhurried host, lab seconds.
    """

    arm: Arm
    mapping: CanMapping
    name: str
    begin_s: float
    end_s: float
    latency_s: float
    messages: tuple[Message, ...]
    foreign: int  # frames that the mapping does not name
    most_repeated: int  # longest row of one and the same frame, byte for byte
    frames: int
    line_faults: int
    confirmed_silent: bool
    status_flags: int | None
    error_frames: int

    @property
    def duration_s(self) -> float:
        """Return how long was listened, lab seconds."""
        return self.end_s - self.begin_s

    def angles_rad(self, joint: str) -> npt.NDArray[np.float64]:
        """Return all angles (n,) that came of a joint."""
        found = [
            u.joints_rad[joint] for m in self.messages for u in m.updates if joint in u.joints_rad
        ]
        return np.array(found)


def mapping_of(arm: Arm) -> CanMapping:
    """Return the arm's CAN mapping, or raise ArmError if its file has none."""
    if arm.can is None:
        raise ArmError(
            f"arm {arm.name}: wanted a [can] section, which says how frames become joint angles, "
            "got none; see docs/arm-file.md"
        )
    return arm.can


def listen(
    source: CanSource, arm: Arm, *, lab_s: float, clock: Clock, latency_wall_s: float
) -> CanRecording:
    """Listen for a while; nothing is sent to the bus."""
    mapping = mapping_of(arm)
    begin_s = clock.now_s()
    heard: list[tuple[float, CanFrame]] = []
    ask_at_s = begin_s
    while (now_s := clock.now_s()) < begin_s + lab_s:
        if now_s >= ask_at_s:
            source.ask_status()
            ask_at_s = now_s + ASK_S
        left_s = min(begin_s + lab_s - now_s, ASK_S)
        if source.fileno() < 0:
            clock.sleep(min(left_s, POLL_S))
        elif not select.select([source.fileno()], [], [], clock.wall_s(left_s))[0]:
            continue
        source.collect(clock.now_s())
        heard += [(at_s, frame) for at_s, frames in source.take() for frame in frames]
    messages, foreign = _decoded(heard, mapping)
    return CanRecording(
        arm=arm,
        mapping=mapping,
        name=source.name,
        begin_s=begin_s,
        end_s=clock.now_s(),
        latency_s=latency_wall_s / clock.wall_s(1.0),
        messages=messages,
        foreign=foreign,
        most_repeated=_longest_row([frame for _, frame in heard]),
        frames=len(heard),
        line_faults=source.faults,
        confirmed_silent=source.confirmed_silent,
        status_flags=source.status_flags,
        error_frames=source.error_frames,
    )


def _decoded(
    heard: list[tuple[float, CanFrame]], mapping: CanMapping
) -> tuple[tuple[Message, ...], int]:
    decoder = CanDecoder(mapping)
    names = list(dict.fromkeys(joint.message for joint in mapping.joints))
    if mapping.drive_state is not None and mapping.drive_state.message not in names:
        names.append(mapping.drive_state.message)
    arrivals: dict[str, list[float]] = {name: [] for name in names}
    updates: dict[str, list[CanUpdate]] = {name: [] for name in names}
    refused: dict[str, list[str]] = {name: [] for name in names}
    foreign = 0
    for at_s, frame in heard:
        try:
            update = decoder.decode(frame)
        except CanError as error:
            name = str(error).partition(".")[0].partition(":")[0]
            refused.setdefault(name, []).append(str(error))
            continue
        if update is None:
            foreign += 1
            continue
        arrivals.setdefault(update.message, []).append(at_s)
        updates.setdefault(update.message, []).append(update)
    return tuple(
        Message(
            name=name,
            arrivals_s=frozen_array(arrivals.get(name, []), np.float64),
            updates=tuple(updates.get(name, [])),
            refused=tuple(refused.get(name, [])),
        )
        for name in dict.fromkeys([*arrivals, *refused])
    ), foreign


def _longest_row(frames: list[CanFrame]) -> int:
    """Return how often one frame came again and again, no other in between."""
    rows: Counter[int] = Counter()
    row = 0
    for before, after in itertools.pairwise(frames):
        row += before != after
        rows[row] += 1
    return max(rows.values(), default=0)
