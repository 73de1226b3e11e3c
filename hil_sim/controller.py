"""The arm's controller: moves the arm, and tells its joint angles to an slcan adapter's line."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from typing import Generic

import cantools.database.can
import numpy as np
import numpy.typing as npt

from armodal.hil_sim.cell import BlowT, Cell
from armodal.hil_sim.clock import LabClock
from armodal.hil_sim.faults import Fault, FaultSet
from armodal.hil_sim.motion import Motion
from armodal.hil_sim.pty_port import PtyPort
from armodal.hil_sim.slcan_adapter import SlcanAdapter
from armodal.hil_sim.streams import Streams
from armodal.protocols.slcan import encode_slcan

__all__ = ["Controller"]

# Bytes that may wait for the adapter's line; beyond them frames are lost, as in an adapter.
ADAPTER_BUFFER = 8192
# Cycles made up for after a late step; older ones are lost.
MOST_CYCLES = 64

TWITCH_RAD, MOVE_RAD = np.radians(2.0), np.radians(3.0)
CORRUPT_SHARE = 0.01  # of the characters on the line: every third line or so

HELD, MOVING = 2, 3  # DRIVE_STATE
RATE_HZ = 125.0
BITRATE = 500_000
MAX_SPEED_RAD_S = 1.0
SETTLE_S = 0.5  # from the end of a motion until the arm is said to be there
ENCODER_NOISE_RAD = 2e-6
ENCODER_STEP_RAD = 2.0 * np.pi / 2**20
DATABASE = "armodal_controller.dbc"


class JointMessages:
    """Lines of one cycle, encoded by the DBC shipped with the protocols."""

    def __init__(self) -> None:
        text = (resources.files("armodal.protocols") / "dbc" / DATABASE).read_text(encoding="utf-8")
        can_database = cantools.database.can.Database()
        can_database.add_dbc_string(text)
        self._messages = [
            (
                message,
                [
                    (signal.name, int(signal.name.removeprefix("POSITION_")) - 1, signal.scale)
                    for signal in message.signals
                    if signal.name.startswith("POSITION_")
                ],
            )
            for message in can_database.messages
        ]

    @property
    def per_cycle(self) -> int:
        """Frames a cycle."""
        return len(self._messages)

    def lines(self, joints_deg: Sequence[float], state: int, counter: int) -> bytes:
        """Return the slcan lines of one cycle."""
        lines = []
        for message, positions in self._messages:
            raw = {name: round(joints_deg[i] / scale) for name, i, scale in positions}
            raw |= {"DRIVE_STATE": state, "COUNTER": counter}
            data = message.encode(raw, scaling=False, strict=False)
            lines.append(encode_slcan(message.frame_id, data, extended=message.is_extended_frame))
        return b"".join(lines)


class Controller(Generic[BlowT]):
    """Moves the arm and tells of it.

    Attributes
    ----------
    adapter
        The adapter, with the count of frames it was asked to transmit.
    frames_lost
        Frames that found no room on the adapter's line.
    """

    def __init__(
        self,
        cell: Cell[BlowT],
        port: PtyPort,
        *,
        clock: LabClock,
        faults: FaultSet,
        streams: Streams,
    ) -> None:
        self.port = port
        self.adapter = SlcanAdapter(bitrate=BITRATE)
        self.frames_lost = 0
        self._cell = cell
        self._clock = clock
        self._faults = faults
        self._encoders, self._noise = streams("encoders"), streams(Fault.CAN_CORRUPT)
        self._messages = JointMessages()
        self._begin_s = clock.now_s()
        self._cycle = 0
        self._motion = Motion.plan(
            cell.joints_rad, cell.joints_rad, begin_s=self._begin_s, max_speed_rad_s=1.0
        )
        self._moving = False
        self._return_to: npt.NDArray[np.float64] | None = None

    @property
    def wants_write(self) -> bool:
        """Whether to be woken when the line has room."""
        return self.port.pending > 0

    @property
    def joints_rad(self) -> npt.NDArray[np.float64]:
        """(n_joints,) where the arm truly is now."""
        return self._motion.joints_rad(self._clock.now_s())

    def move_to(self, joints_rad: npt.ArrayLike) -> float:
        """Set the arm moving; return the lab time at which it has settled."""
        now_s = self._clock.now_s()
        self._motion = Motion.plan(
            self.joints_rad,
            joints_rad,
            begin_s=now_s,
            max_speed_rad_s=MAX_SPEED_RAD_S,
        )
        self._moving = True
        self._cell.set_moving()
        return self._motion.end_s + SETTLE_S

    def step(self) -> None:
        """Do what is to be done now; never waits."""
        now_s = self._clock.now_s()
        self._suffer(now_s)
        if self._moving and not self._motion.moving(now_s):
            self._moving = False
            self._cell.set_posture(self._motion.goal_rad)
        data = self.port.read()
        if data:
            self.port.queue(self.adapter.feed(data))
        self._tell(now_s)
        self.port.flush()

    def _suffer(self, now_s: float) -> None:
        """Let the arm move by itself where a fault makes it."""
        if self._return_to is not None and not self._motion.moving(now_s):
            self.move_to(self._return_to)
            self._return_to = None
        twitches = self._faults.take(Fault.ARM_TWITCHES)
        if twitches or self._faults.take(Fault.ARM_MOVES):
            here_rad = self.joints_rad
            there_rad = here_rad.copy()
            there_rad[0] += TWITCH_RAD if twitches else MOVE_RAD
            self._return_to = here_rad if twitches else None
            self.move_to(there_rad)

    def _on_line(self, lines: bytes) -> bytes:
        """Return the lines of a cycle as they reach the host."""
        if Fault.CAN_CORRUPT not in self._faults:
            return lines
        noisy = bytearray(lines)
        for at in np.flatnonzero(self._noise.random(len(noisy)) < CORRUPT_SHARE):
            noisy[at] = self._noise.integers(256)
        return bytes(noisy)

    def _tell(self, now_s: float) -> None:
        due = int((now_s - self._begin_s) * RATE_HZ)
        first = max(self._cycle, due - MOST_CYCLES)
        if self.adapter.forwards and Fault.CAN_SILENCE not in self._faults:
            self.frames_lost += self._messages.per_cycle * (first - self._cycle)
            told_deg = self._told_deg(first, due)
            for cycle, joints_deg in zip(range(first, due), told_deg, strict=True):
                if self.port.pending > ADAPTER_BUFFER:
                    self.adapter.overrun()
                    self.frames_lost += self._messages.per_cycle
                else:
                    state = MOVING if self._motion.moving(self._cycle_s(cycle)) else HELD
                    lines = self._messages.lines(joints_deg, state, cycle & 0xFF)
                    self.port.queue(self._on_line(lines))
        self._cycle = due

    def _cycle_s(self, cycle: int) -> float:
        """Lab time of a cycle."""
        return self._begin_s + cycle / RATE_HZ

    def _told_deg(self, first: int, due: int) -> list[list[float]]:
        """Angles of the cycles `first` to `due` - 1 as the encoders read them."""
        if first == due:
            return []
        true_rad = np.array(
            [self._motion.joints_rad(self._cycle_s(cycle)) for cycle in range(first, due)]
        )
        noise_rad = ENCODER_NOISE_RAD * self._encoders.standard_normal(true_rad.shape)
        read_rad = ENCODER_STEP_RAD * np.round((true_rad + noise_rad) / ENCODER_STEP_RAD)
        told_deg: list[list[float]] = np.degrees(read_rad).tolist()
        return told_deg
