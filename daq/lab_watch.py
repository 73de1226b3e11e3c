"""Before a session: watch board and bus, and take hits for trial; nothing is kept.

A process of its own, like the acquisition whose place it holds: it hears `TriggerLevel` and
`Stop`, and tells what is there. A device that is missing is looked for again and again.
"""

from __future__ import annotations

import dataclasses
import select
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from armodal.daq.blocks import CapturedBlock
from armodal.daq.board_link import BoardLink
from armodal.daq.board_session import BoardSession
from armodal.daq.clock import Clock, SystemClock
from armodal.daq.commands import Command, Stop, TriggerLevel
from armodal.daq.events import BoardFound, DeviceTrouble, Finished, JointsSeen, LossNoted, TrialHit
from armodal.daq.health import HEALTH_EVERY_WALL_S, health_of
from armodal.daq.joint_source import JointSource
from armodal.daq.judge import force_column, judge_record, prepare_judge
from armodal.daq.losses import LossTally
from armodal.daq.open_joints import can_mapping, open_joints
from armodal.daq.outbox import Outbox
from armodal.daq.preview import PREVIEW_EVERY_WALL_S
from armodal.daq.serial_port import BytePort
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.surroundings import Surroundings, open_board
from armodal.protocols.errors import ArmodalError

__all__ = ["run_lab_watch"]

TURN_WALL_S = 0.012
FAREWELL_WALL_S = 1.0
EVERY_WALL_S = {
    "retry": 1.5,
    "preview": PREVIEW_EVERY_WALL_S,
    "joints": 0.2,
    "health": HEALTH_EVERY_WALL_S,
}


def run_lab_watch(settings: AcquisitionSettings, channel: Connection[Any, Any]) -> int:
    """Watch until `Stop` comes or the listener goes; return the exit code, 0.

    Parameters
    ----------
    settings
        Ports, arm and plan; an empty port is one that is not chosen yet. The journal is left
        alone.
    channel
        Receives commands, is sent events.
    """
    prepare_judge()
    watch = _LabWatch(settings, Outbox(channel), SystemClock(settings.time_scale))
    stop = None
    while stop is None:
        for command in _commands(channel):
            if isinstance(command, Stop):
                stop = command
            elif isinstance(command, TriggerLevel):
                watch.set_trigger(command.level_n)
        watch.turn()
    watch.close(stop.reason)
    return 0


def _commands(channel: Connection[Any, Any]) -> tuple[Command, ...]:
    said: list[Command] = []
    try:
        while channel.poll(0):
            said.append(channel.recv())
    except (EOFError, OSError):
        said.append(Stop(reason="the listener has gone"))
    return tuple(said)


class _LabWatch:
    """Board and bus as far as they are there."""

    def __init__(self, settings: AcquisitionSettings, outbox: Outbox, clock: Clock) -> None:
        if not settings.without_bus:
            can_mapping(settings.arm)
        self._settings = settings
        self._outbox = outbox
        self._clock = clock
        self._losses = LossTally()
        self._port: BytePort | None = None
        self._board: BoardSession | None = None
        self._joints: JointSource | None = None
        self._trouble: dict[str, str | None] = {}
        self._due = dict.fromkeys(EVERY_WALL_S, 0.0)

    def set_trigger(self, level_n: float) -> None:
        """Set the board up anew, with another level."""
        plan = self._settings.plan
        trigger = dataclasses.replace(plan.trigger, level_n=level_n)
        self._settings = dataclasses.replace(
            self._settings, plan=dataclasses.replace(plan, trigger=trigger)
        )
        self._drop_board()

    def turn(self) -> None:
        """Look, listen and tell, once."""
        now_s = self._clock.now_s()
        if self._is_due("retry", now_s):
            self._open_what_is_missing(now_s)
        descriptors = [self._board.fileno()] if self._board else []
        if self._joints is not None and self._joints.fileno() >= 0:
            descriptors.append(self._joints.fileno())
        self._clock.sleep(TURN_WALL_S / self._clock.wall_s(1.0))
        ready = select.select(descriptors, [], [], 0.0)[0]
        now_s = self._clock.now_s()
        self._hear_joints(now_s)
        self._hear_board(now_s, ready)
        self._report(now_s)

    def close(self, reason: str) -> None:
        """Let go of the devices, and say so."""
        self._drop_board()
        if self._joints is not None:
            self._joints.close()
        self._outbox.put(
            Finished(
                complete=False,
                reason=reason,
                journal="",
                accepted=0,
                rejected=0,
                cpu_s=0.0,
                previews_dropped=self._outbox.previews_dropped,
                samples_taken=None,
                samples_seen=0,
            )
        )
        self._outbox.finish(FAREWELL_WALL_S)

    def _open_what_is_missing(self, now_s: float) -> None:
        if self._board is None and self._settings.board_port:
            try:
                self._open_board()
            except ArmodalError as error:
                self._drop_board()
                self._tell_trouble("board", str(error))
            else:
                self._tell_trouble("board", None)
        if self._joints is None and self._settings.has_joint_source:
            try:
                self._joints = open_joints(self._settings, Surroundings.of(self._settings))
            except ArmodalError as error:
                self._tell_trouble("can", str(error))
            else:
                self._tell_trouble("can", None)
        self._due["retry"] = now_s + EVERY_WALL_S["retry"] / self._clock.wall_s(1.0)

    def _open_board(self) -> None:
        settings = self._settings
        self._port = open_board(settings)
        link = BoardLink(
            self._port,
            self._clock,
            reply_timeout_s=settings.reply_timeout_s,
            give_up_wall_s=settings.give_up_wall_s,
        )
        board = BoardSession(link, link.hello(), settings, self._clock, self._losses)
        board.prepare()
        board.start()
        self._board = board
        self._outbox.put(
            BoardFound(
                port=settings.board_port,
                dictionary=board.found.dictionary,
                channel_mask=board.mask,
            )
        )

    def _drop_board(self) -> None:
        board, self._board = self._board, None
        port, self._port = self._port, None
        try:
            if board is not None:
                board.stop()
        except ArmodalError as error:
            self._tell_trouble("board", str(error))
        finally:
            if port is not None:
                port.close()

    def _hear_joints(self, now_s: float) -> None:
        if self._joints is None:
            return
        try:
            self._joints.collect(now_s)
            self._joints.hear()
        except ArmodalError as error:
            self._joints.close()
            self._joints = None
            self._tell_trouble("can", str(error))

    def _hear_board(self, now_s: float, ready: list[int]) -> None:
        board = self._board
        if board is None:
            return
        try:
            board.turn(now_s, readable=board.fileno() in ready)
            while (block := board.captured(now_s)) is not None:
                self._judge(board, block)
                board.release(block.info.block_id, now_s)
            board.count_losses(now_s)
        except ArmodalError as error:
            self._drop_board()
            self._tell_trouble("board", str(error))

    def _judge(self, board: BoardSession, block: CapturedBlock) -> None:
        plan = self._settings.plan
        verdict = judge_record(
            block,
            board.channels,
            plan.sampling,
            plan.trigger,
            self._settings.limits,
            exponential_end=plan.windows.exponential_end,
        )
        column = force_column(board.channels)
        before = block.counts[: max(block.info.trigger_sample - block.first_sample - 16, 2), column]
        self._outbox.put(
            TrialHit(
                counts=block.counts,
                first_sample=block.first_sample,
                trigger_sample=block.info.trigger_sample,
                verdict=verdict,
                force_noise_n=float(np.std(before)) * abs(board.channels[column].scale),
            )
        )

    def _report(self, now_s: float) -> None:
        if self._is_due("preview", now_s) and self._board is not None:
            preview = self._board.stream.preview()
            if preview is not None:
                self._outbox.put(preview)
        if self._is_due("joints", now_s) and self._joints is not None:
            self._outbox.put(JointsSeen(reading=self._joints.joints.reading(now_s)))
        if self._is_due("health", now_s):
            self._outbox.put(health_of(self._board, self._joints))
            for loss in self._losses.take():
                self._outbox.put(LossNoted(loss=loss))

    def _tell_trouble(self, device: str, message: str | None) -> None:
        if self._trouble.get(device, "") != message:
            self._trouble[device] = message
            self._outbox.put(DeviceTrouble(device=device, message=message))

    def _is_due(self, what: str, now_s: float) -> bool:
        if now_s < self._due[what]:
            return False
        self._due[what] = now_s + EVERY_WALL_S[what] / self._clock.wall_s(1.0)
        return True
