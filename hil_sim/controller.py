"""The arm's controller: moves the arm, and tells its joint angles to an slcan adapter's line."""

from __future__ import annotations

from typing import Generic

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.cell import BlowT, Cell
from armodal.hil_sim.clock import LabClock
from armodal.hil_sim.faults import Fault, FaultSet
from armodal.hil_sim.joint_messages import JointMessages
from armodal.hil_sim.motion import Motion
from armodal.hil_sim.pty_port import PtyPort
from armodal.hil_sim.slcan_adapter import SlcanAdapter
from armodal.hil_sim.streams import Streams

__all__ = ["Controller"]

# Bytes that may wait for the adapter's line; beyond them frames are lost, as in an adapter.
ADAPTER_BUFFER = 8192
# Cycles made up for after a late step; older ones are lost.
MOST_CYCLES = 64

TWITCH_RAD, MOVE_RAD = np.radians(2.0), np.radians(3.0)
CORRUPT_SHARE = 0.01  # of the characters on the line: every third line or so

MAX_SPEED_RAD_S = 1.0
SETTLE_S = 0.5  # from the end of a motion until the arm is said to be there
ENCODER_NOISE_RAD = 2e-6
ENCODER_STEP_RAD = 2.0 * np.pi / 2**20


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
        messages: JointMessages,
        clock: LabClock,
        faults: FaultSet,
        streams: Streams,
    ) -> None:
        self.port = port
        self.adapter = SlcanAdapter(bitrate=messages.bitrate)
        self.frames_lost = 0
        self._cell = cell
        self._clock = clock
        self._faults = faults
        self._encoders, self._noise = streams("encoders"), streams(Fault.CAN_CORRUPT)
        self._messages = messages
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
        due = int((now_s - self._begin_s) * self._messages.rate_hz)
        first = max(self._cycle, due - MOST_CYCLES)
        if self.adapter.forwards and Fault.CAN_SILENCE not in self._faults:
            self.frames_lost += self._messages.per_cycle * (first - self._cycle)
            told_rad = self._told_rad(first, due)
            for cycle, joints_rad in zip(range(first, due), told_rad, strict=True):
                if self.port.pending > ADAPTER_BUFFER:
                    self.adapter.overrun()
                    self.frames_lost += self._messages.per_cycle
                else:
                    moving = self._motion.moving(self._cycle_s(cycle))
                    lines = self._messages.lines(joints_rad, moving=moving, counter=cycle)
                    self.port.queue(self._on_line(lines))
        self._cycle = due

    def _cycle_s(self, cycle: int) -> float:
        """Lab time of a cycle."""
        return self._begin_s + cycle / self._messages.rate_hz

    def _told_rad(self, first: int, due: int) -> list[list[float]]:
        """Angles of the cycles `first` to `due` - 1 as the encoders read them."""
        if first == due:
            return []
        true_rad = np.array(
            [self._motion.joints_rad(self._cycle_s(cycle)) for cycle in range(first, due)]
        )
        noise_rad = ENCODER_NOISE_RAD * self._encoders.standard_normal(true_rad.shape)
        read_rad = ENCODER_STEP_RAD * np.round((true_rad + noise_rad) / ENCODER_STEP_RAD)
        told_rad: list[list[float]] = read_rad.tolist()
        return told_rad
