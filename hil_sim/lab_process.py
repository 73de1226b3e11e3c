"""The laboratory's process: board, controller and operator in one loop that never blocks."""

from __future__ import annotations

import os
import select
import signal
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Generic

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.board import Board
from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.board_state import BoardFirmware, Converter
from armodal.hil_sim.cell import BlowT, Cell, Source
from armodal.hil_sim.clock import DeviceClock, LabClock
from armodal.hil_sim.controller import Controller
from armodal.hil_sim.faults import FaultSet
from armodal.hil_sim.joint_messages import JointMessages
from armodal.hil_sim.ledger import LedgerWriter
from armodal.hil_sim.operator import Marking, Operator, Swing, Workplace
from armodal.hil_sim.operator_socket import OperatorSocket, check_free
from armodal.hil_sim.plant import Plant
from armodal.hil_sim.pty_port import PtyPort
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.generic_can import generic_mapping
from armodal.protocols.arm.records import CanMapping

__all__ = ["ArmInCell", "LabOptions", "LabProcess"]

SOCKET_NAME = "operator.sock"
LEDGER_NAME = "ledger.jsonl"

# Longest sleep of the loop, wall seconds: short against the time the 12 to 20 KB that a
# pseudo-terminal holds take to fill.
TICK_S = 0.003

# The board's clock against the laboratory's.
CLOCK_ERROR_PPM = 37.0
CLOCK_OFFSET_TICKS = 12_345_678


@dataclass(frozen=True, slots=True, kw_only=True)
class LabOptions:
    """What a laboratory is started with.

    `effects` are what its truth hides beside the plant's springs; a sealed ledger is read by
    `hil_sim.ledger` alone.
    """

    seed: int
    directory: Path
    time_scale: float = 1.0
    faults: tuple[str, ...] = ()
    sealed: bool = False
    effects: tuple[Mapping[str, object], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmInCell(Generic[BlowT]):
    """The arm with its sensors, the hand that hits it, and what its controller says.

    Without `can` the controller speaks armodal's own description.
    """

    plant: Plant
    make_source: Callable[[Fraction], Source[BlowT]]
    swing: Swing[BlowT]
    mounted: Callable[[], Mapping[str, object]]
    swing_at_mass: Callable[[float], tuple[BlowT, Mapping[str, object]]] | None = None
    mark: Callable[[str, Marking], None] | None = None
    can: CanMapping | None = None


class LabProcess(Generic[BlowT]):
    """Everything of the laboratory; `serve` runs it.

    Raises
    ------
    PlantError
        If a fault is not known or the directory's path is too long.
    """

    def __init__(self, arm: ArmInCell[BlowT], options: LabOptions) -> None:
        self._stopping = False
        self._stdin = -1
        with ExitStack() as keep:
            self._build(arm, options, keep)
            self._exit = keep.pop_all()

    def _build(self, arm: ArmInCell[BlowT], options: LabOptions, keep: ExitStack) -> None:
        plant = arm.plant
        streams = partial(stream, options.seed)
        clock = LabClock(scale=options.time_scale)
        faults = FaultSet(options.faults)
        self._clock = clock
        self._input_range_v = plant.truth.board.range_v
        check_free(options.directory / SOCKET_NAME)
        self.ledger_path = options.directory / LEDGER_NAME
        self._ledger = LedgerWriter(
            self.ledger_path,
            plant,
            seed=options.seed,
            time_scale=options.time_scale,
            effects=options.effects,
            sealed=options.sealed,
        )
        keep.callback(self._ledger.close)
        cell = Cell(
            arm.make_source,
            joints_rad=_at_first(plant),
            point=next(iter(plant.points)),
        )
        self._cell = cell
        board_port = keep.enter_context(closing(PtyPort()))
        can_port = keep.enter_context(closing(PtyPort()))
        device_clock = DeviceClock(
            lab=clock,
            boot_s=clock.now_s(),
            error_ppm=CLOCK_ERROR_PPM,
            offset_ticks=CLOCK_OFFSET_TICKS,
        )
        firmware = BoardFirmware(
            board_dictionary(plant.truth, tick_hz=device_clock.tick_hz),
            session=int(streams("board session").integers(1, 1 << 32)),
            clock=device_clock,
            converter=Converter(start=self._start, stop=cell.stop_sampling, read=cell.read),
        )
        self.board = Board(firmware, board_port, faults=faults, streams=partial(streams, "board"))
        joints = [link.joint for link in plant.truth.links]
        self.controller = Controller(
            cell,
            can_port,
            messages=JointMessages(arm.can or generic_mapping(joints), joints),
            clock=clock,
            faults=faults,
            streams=partial(streams, "controller"),
        )
        workplace = Workplace(
            cell=cell,
            move_to=self.controller.move_to,
            swing=arm.swing,
            ranges_rad=tuple(
                (float(np.radians(low)), float(np.radians(high)))
                for low, high in (link.range_deg for link in plant.truth.links)
            ),
            points=frozenset(plant.points),
            faults=faults,
            ledger=self._ledger,
            mounted=arm.mounted,
            swing_at_mass=arm.swing_at_mass,
            mark=arm.mark,
        )
        operator = Operator(workplace, clock=clock, streams=partial(streams, "operator"))
        self.operator = OperatorSocket(options.directory / SOCKET_NAME, operator.begin, clock=clock)
        keep.callback(self.operator.close)
        keep.callback(self._note_end)

    def ready(self) -> dict[str, object]:
        """Where everything is, as printed when the laboratory is ready."""
        return {
            "ready": True,
            "board": self.board.port.name,
            "can": self.controller.port.name,
            "operator": str(self.operator.path),
            "ledger": str(self.ledger_path),
            "time_scale": self._clock.scale,
            "input_range_v": self._input_range_v,
            "truth_sha256": self._ledger.truth_sha256,
            "pid": os.getpid(),
        }

    def step(self) -> None:
        """One turn of the loop."""
        self.board.step()
        self.controller.step()
        self.operator.step()

    def obey_signals(self) -> None:
        """Let SIGTERM and SIGINT end `serve`; to be called before anyone knows of the process."""
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._stop)

    def serve(self, *, watch_stdin: bool) -> None:
        """Run until `obey_signals` hears one, and until stdin ends if that is watched."""
        always: list[int] = [self.board.port.fileno(), self.controller.port.fileno()]
        if watch_stdin:
            self._stdin = sys.stdin.fileno()
            always.append(self._stdin)
        try:
            while not self._stopping:
                self._wait(always)
                self.step()
        finally:
            self.close()

    def close(self) -> None:
        """Close everything and remove the socket; the ledger stays."""
        self._exit.close()

    def _wait(self, always: Iterable[int]) -> None:
        devices = (self.board, self.controller)
        writers = [device.port.fileno() for device in devices if device.wants_write]
        readers = [*always, *(ear.fileno() for ear in self.operator.readers())]
        readable, _, _ = select.select(readers, writers, [], TICK_S)
        if self._stdin in readable and not os.read(self._stdin, 4096):
            self._stopping = True

    def _stop(self, _number: int, _frame: FrameType | None) -> None:
        self._stopping = True

    def _start(self, rate_hz: Fraction) -> None:
        self._cell.start_sampling(rate_hz)
        self._ledger.note("sampling", self._clock.now_s(), rate_hz=float(rate_hz))

    def _note_end(self) -> None:
        self._ledger.note(
            "end",
            self._clock.now_s(),
            can_transmissions=self.controller.adapter.transmissions,
            can_frames_lost=self.controller.frames_lost,
        )


def _at_first(plant: Plant) -> npt.NDArray[np.float64]:
    """(n_joints,) zero, or the end of the joint's range that is nearest to it."""
    low, high = np.radians([link.range_deg for link in plant.truth.links]).T
    nearest: npt.NDArray[np.float64] = np.clip(np.zeros(len(low)), low, high)
    return nearest
