"""The simulated board on a line in memory, and a clock that runs only while its host waits.

What a check takes and what comes of it do not depend on how busy the machine is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from support.virtual_lab import BOARD_FD, HostEnd, MemoryLine

from armodal.hil_sim.arm_in_cell import arm_in_cell
from armodal.hil_sim.board import Board
from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.board_state import BoardFirmware, Converter
from armodal.hil_sim.broken_board import BrokenBoard
from armodal.hil_sim.cell import Cell
from armodal.hil_sim.clock import DeviceClock, LabClock
from armodal.hil_sim.faults import FaultSet
from armodal.hil_sim.plant import Plant
from armodal.hil_sim.relay import Alteration
from armodal.hil_sim.slcan_adapter import SlcanAdapter
from armodal.hil_sim.streams import stream

SEED = 1
STEP_S = 0.004  # in which a device looks at its line once


class RelayedLine(MemoryLine):
    """A line whose bytes are altered on their way, as those of `hil_sim.relay` are."""

    def __init__(self, name: str, alteration: Alteration) -> None:
        super().__init__(name, BOARD_FD)
        self._alteration = alteration

    def read(self) -> bytes:
        return self._alteration.to_device(super().read())

    def queue(self, data: bytes) -> None:
        super().queue(self._alteration.to_host(data))


class VirtualClock:
    """Seconds in which a device does what is due; they pass while its host waits."""

    def __init__(self) -> None:
        self._now_s = 1000.0
        self.line: MemoryLine | None = None
        self.step: Callable[[], None] = lambda: None

    def now_s(self) -> float:
        return self._now_s

    def sleep(self, lab_s: float) -> None:
        until_s = self._now_s + lab_s
        while self._now_s < until_s:
            self._pass(until_s)

    def wall_s(self, lab_s: float) -> float:
        return lab_s

    def wait(self, descriptors: Iterable[int], wall_s: float) -> list[int]:
        until_s = self._now_s + wall_s
        while not (ready := self.line.is_readable()) and self._now_s < until_s:
            self._pass(until_s)
        return list(descriptors) if ready else []

    def _pass(self, until_s: float) -> None:
        self._now_s = min(self._now_s + STEP_S, until_s)
        self.step()


class VirtualBoard:
    """A board with the arm before it, as the laboratory's process has it."""

    def __init__(
        self,
        plant: Plant,
        alteration: Alteration | None = None,
        *,
        receive_bytes: int | None = None,
    ) -> None:
        self.clock = VirtualClock()
        self.line = RelayedLine("board", alteration or BrokenBoard())
        lab = LabClock(monotonic=self.clock.now_s)
        cell = Cell(
            arm_in_cell(plant, seed=SEED).make_source,
            joints_rad=[0.0] * len(plant.truth.links),
            point=next(iter(plant.points)),
        )
        device_clock = DeviceClock(
            lab=lab, boot_s=lab.now_s(), error_ppm=37.0, offset_ticks=12_345_678
        )
        firmware = BoardFirmware(
            board_dictionary(plant.truth, tick_hz=device_clock.tick_hz),
            session=int(stream(SEED, "board session").integers(1, 1 << 32)),
            clock=device_clock,
            converter=Converter(start=cell.start_sampling, stop=cell.stop_sampling, read=cell.read),
            receive_bytes=receive_bytes,
        )
        board = Board(firmware, self.line, faults=FaultSet(()), streams=partial(stream, SEED))
        self.clock.line, self.clock.step = self.line, board.step

    def open(self) -> HostEnd:
        return self.line.host()


class VirtualAdapter:
    """A CAN adapter, which is no board."""

    def __init__(self) -> None:
        self.clock = VirtualClock()
        self.line = MemoryLine("can", BOARD_FD)
        self._adapter = SlcanAdapter(bitrate=500_000)
        self.clock.line, self.clock.step = self.line, self._step

    def _step(self) -> None:
        self.line.queue(self._adapter.feed(self.line.read()))
        self.line.flush()

    def open(self) -> HostEnd:
        return self.line.host()
