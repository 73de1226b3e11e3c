"""The loop of a session: joints, board and operator in, durable hits and prompts out."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from armodal.daq import session_machine as machine
from armodal.daq.arm_around import ArmAround
from armodal.daq.blocks import CapturedBlock
from armodal.daq.board_session import BoardSession
from armodal.daq.clock import Clock
from armodal.daq.commands import (
    Command,
    MovePoint,
    Note,
    Ready,
    Retake,
    Skip,
    StatedPosture,
    Stop,
    Withdraw,
)
from armodal.daq.events import (
    HitJudged,
    HitWithdrawn,
    PointMoved,
)
from armodal.daq.hit_tally import HitTally
from armodal.daq.joint_source import JointSource
from armodal.daq.journal_mirror import MirroredJournal
from armodal.daq.journal_writer import JournalWriter
from armodal.daq.judge import force_column
from armodal.daq.judged_hit import judged_hit
from armodal.daq.losses import LossTally
from armodal.daq.moved_points import MovedPoints
from armodal.daq.session_machine import PromptKind, SessionState
from armodal.daq.session_marks import what_was_done, withdrawal
from armodal.daq.session_reports import DueTimes, SessionReports
from armodal.daq.session_steps import SessionSteps
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.stopping import Stopping, begin_stopping
from armodal.daq.surroundings import EventQueue
from armodal.daq.triggered_blocks import HitBlock, StrayBlock, TriggeredBlocks
from armodal.daq.untriggered import UntriggeredPushes
from armodal.protocols.arm.records import Arm
from armodal.protocols.force_pulse import TURNED
from armodal.protocols.session.journal import MarkKind, encode_hit
from armodal.protocols.session.journal_payloads import CALIBRATION
from armodal.protocols.session.records import JointReading

__all__ = ["SessionLoop"]

POSTURE_EVERY_WALL_S = 0.05


class SessionLoop:
    """All that happens between opening and closing.

    Call `turn` again and again with the time and what the operator has said, until `ended`.
    """

    def __init__(
        self,
        *,
        settings: AcquisitionSettings,
        clock: Clock,
        board: BoardSession,
        joints: JointSource,
        losses: LossTally,
        journal: JournalWriter | MirroredJournal,
        outbox: EventQueue,
        state: SessionState,
        accepted_before: tuple[tuple[int, str, str], ...] = (),
        polarities_before: Mapping[int, int] | None = None,
        arm: Arm | None = None,
        next_hit: int,
        turn_s: float,
    ) -> None:
        self._settings = settings
        self._clock = clock
        self._board = board
        self._source = joints
        self._joints = joints.joints
        self._losses = losses
        self._journal = journal
        self._outbox = outbox
        self._arm = ArmAround(settings, clock, joints.joints, turn_s)
        self._moved = MovedPoints(arm or settings.arm, settings.plan)
        self._silent = False
        self._jumped_s = -math.inf
        self._due = DueTimes(clock)
        self._rate_hz = float(settings.plan.sampling.rate_hz)
        self._blocks = TriggeredBlocks(board, joints, self._arm, losses, self._rate_hz)
        self._steps = SessionSteps(
            state, blocks=self._blocks, source=joints, journal=journal, outbox=outbox
        )
        self.hits = HitTally(settings.plan, next_hit, accepted_before, polarities_before)
        self._reports = SessionReports(
            clock=clock,
            board=board,
            joints=joints,
            losses=losses,
            journal=journal,
            outbox=outbox,
            untriggered=UntriggeredPushes(board.channels, settings.plan.trigger),
            note=self.note,
        )
        self._stopping: Stopping | None = None
        self.ended: str | None = None

    @property
    def _state(self) -> SessionState:
        return self._steps.state

    @property
    def complete(self) -> bool:
        """Whether every planned point has its accepted hits."""
        return self._state.lacking == 0

    def turn(self, now_s: float, commands: tuple[Command, ...]) -> None:
        """Do what is due."""
        for command in commands:
            self._obey(command, now_s)
        if self._due.is_due("posture", POSTURE_EVERY_WALL_S, now_s):
            self._source.hear()
            self._follow_posture(self._joints.reading(now_s), now_s)
        if self._board.clock_jumped_s > self._jumped_s:
            self._jumped_s = self._board.clock_jumped_s
            self.note("the board's clock jumped: hits taken meanwhile are not used", now_s)
        self._judge_blocks(now_s)
        self._reports.tell(now_s)
        if self._state.kind is PromptKind.DONE and self.ended is None and not self._blocks:
            self.ended = what_was_done(self._state)
        stopping = self._stopping
        if stopping is not None and self.ended is None:
            asked = self._state.kind is PromptKind.HIT
            under_way = asked or bool(self._blocks) or self._board.blocks_under_way > 0
            if stopping.may_end(now_s, hit_under_way=under_way):
                self.ended = stopping.reason

    def flush_losses(self) -> None:
        """Put what was lost so far into the journal."""
        self._reports.flush_losses()

    def interrupt(self, reason: str) -> None:
        """Keep what is known when the session cannot go on: the losses so far, and the reason."""
        self._steps.mark(MarkKind.NOTE, self._clock.now_s(), f"interrupted: {reason}")
        self.flush_losses()

    def note(self, text: str, now_s: float) -> None:
        """Tell the operator something, and keep it."""
        self._steps.note(text, now_s)

    def _obey(self, command: Command, now_s: float) -> None:
        state = self._state
        if isinstance(command, Ready):
            if state.kind is PromptKind.POSTURE:
                self.note("ready came before the arm was at its posture, and was not taken", now_s)
            elif state.kind is PromptKind.POINT:
                self._steps.mark(MarkKind.POINT, now_s)
                self._steps.change(machine.point_ready(state), now_s)
        elif isinstance(command, StatedPosture):
            self.note(self._source.take_posture(command, state.posture, now_s), now_s)
        elif isinstance(command, Skip):
            self._steps.mark(MarkKind.SKIPPED, now_s, command.reason)
            self._steps.change(machine.skip(state), now_s)
        elif isinstance(command, Retake):
            try:
                changed = machine.retake(state, command.posture, command.point)
            except KeyError as error:
                self.note(f"retake: the plan has no {error.args[0]}", now_s)
                return
            self._steps.change(changed, now_s)
            if changed.here is not None:
                self._steps.mark(
                    MarkKind.POINT, now_s, "retaken"
                )  # it goes on here when come back to
        elif isinstance(command, Withdraw):
            self._withdraw(now_s)
        elif isinstance(command, MovePoint):
            self._move(command, now_s)
        elif isinstance(command, Note):
            self.note(command.text, now_s)
        elif isinstance(command, Stop):
            self._stopping = begin_stopping(
                self._stopping,
                command,
                now_s,
                record_s=self._settings.plan.sampling.samples / self._rate_hz,
                wall_s=self._clock.wall_s(1.0),
            )

    def _move(self, command: MovePoint, now_s: float) -> None:
        said, moved = self._moved.take(command, self.hits.points())
        if not moved:
            self.note(said, now_s)
            return
        self._steps.mark(MarkKind.NOTE, now_s, said, point=command.point.id)
        self._outbox.put(PointMoved(point=command.point.id, arm=self._moved.arm))

    def _withdraw(self, now_s: float) -> None:
        taken = self.hits.take_back()
        if taken is None:
            self.note("there is no accepted hit to take back", now_s)
            return
        number, posture, point = taken
        self._journal.append(withdrawal(number, posture, point, now_s))
        self._outbox.put(HitWithdrawn(number=number, posture=posture, point=point))
        self._steps.change(machine.withdraw(self._state, posture, point), now_s)

    def _follow_posture(self, reading: JointReading, now_s: float) -> None:
        silent = reading.joints_rad is None and self._joints.rate_hz is not None
        if silent != self._silent:
            self._silent = silent
            self.note("the controller is silent" if silent else "the controller is back", now_s)
        posture = self._state.posture
        if not self._steps.begun:
            self._steps.change(self._state, now_s)
        if posture is None:
            return
        off = self._arm.is_off(posture, reading)
        if self._state.kind is not PromptKind.POSTURE:
            if off:
                self._steps.change(machine.posture_left(self._state), now_s)
        elif off is False and reading.held and self._arm.is_still(posture, now_s):
            self._steps.mark(MarkKind.POSTURE, now_s)
            self._steps.change(machine.posture_reached(self._state), now_s)

    def _judge_blocks(self, now_s: float) -> None:
        self._blocks.collect(now_s)
        while (taken := self._blocks.take(self._state.current, now_s)) is not None:
            if isinstance(taken, StrayBlock):
                self._set_aside(taken.block, now_s, taken.why)
            else:
                self._judge(taken, now_s)

    def _set_aside(self, block: CapturedBlock, now_s: float, why: str) -> None:
        self._board.release(block.info.block_id, now_s)
        column = force_column(self._board.channels)
        peak_n = float(np.abs(block.counts[:, column]).max(initial=0))
        peak_n *= abs(self._board.channels[column].scale)
        self.note(
            f"block {block.info.block_id} (peak {peak_n:.3g} N) {why}: not used",
            now_s,
        )

    def _judge(self, taken: HitBlock, now_s: float) -> None:
        block, state = taken.block, self._state
        posture = state.posture
        if posture is None:
            self._set_aside(block, now_s, "was triggered when no hit was asked for")
            return
        hit = judged_hit(
            taken,
            self.hits.next_number,
            state.prompt,
            posture,
            arm=self._moved.arm,
            around=self._arm,
            channels=self._board.channels,
            polarity=self.hits.polarity,
            settings=self._settings,
        )
        verdict_s = self._clock.wall_s(self._clock.now_s() - block.last_data_s)
        commit_s = self._journal.append(encode_hit(hit))
        self._board.release(block.info.block_id, now_s)
        turned = self.hits.keep(hit)
        self._outbox.put(
            HitJudged(
                hit=hit,
                verdict_s=verdict_s,
                commit_s=commit_s,
                clock_uncertainty_s=self._board.clock_fit.uncertainty_s(block.info.trigger_ticks),
            )
        )
        if turned:
            self.note(CALIBRATION + TURNED, now_s)
        after = machine.hit_judged(state, accepted=hit.verdict.accepted)
        self._steps.change(after, self._clock.now_s())
