"""The loop of a session: joints, board and operator in, durable hits and prompts out."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

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
    Stop,
    ToldPosture,
    Withdraw,
)
from armodal.daq.events import (
    HitJudged,
    HitWithdrawn,
    JointsSeen,
    LossNoted,
    Noted,
    PointMoved,
    Prompted,
)
from armodal.daq.geometry import hit_direction
from armodal.daq.hammer_polarity import HammerPolarity
from armodal.daq.health import HEALTH_EVERY_WALL_S, health_of
from armodal.daq.joint_source import JointSource
from armodal.daq.journal_mirror import MirroredJournal
from armodal.daq.journal_writer import JournalWriter
from armodal.daq.judge import force_column, judge_record
from armodal.daq.judge_posture import with_posture
from armodal.daq.losses import LossTally
from armodal.daq.moved_points import MovedPoints
from armodal.daq.preview import PREVIEW_EVERY_WALL_S
from armodal.daq.session_machine import PromptKind, SessionState
from armodal.daq.session_marks import mark_of, what_was_done, withdrawal
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.stopping import Stopping, begin_stopping
from armodal.daq.surroundings import EventQueue
from armodal.daq.untriggered import UntriggeredPushes
from armodal.protocols.arm.records import Arm
from armodal.protocols.force_pulse import TURNED
from armodal.protocols.session.journal import MarkKind, encode_hit, encode_loss
from armodal.protocols.session.journal_payloads import CALIBRATION
from armodal.protocols.session.progress import roving_point
from armodal.protocols.session.records import Hit, JointReading

__all__ = ["SessionLoop"]

POSTURE_EVERY_WALL_S = 0.05
JOINTS_EVERY_WALL_S = 0.2
LOSSES_EVERY_WALL_S = 1.0
NOTE_LENGTH = 4096  # of a sentence in the journal


@dataclass(frozen=True, slots=True, kw_only=True)
class _Armed:
    """Which planned point hits belonged to, and in which time."""

    index: int
    since_s: float
    until_s: float = math.inf


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
        self._state = state
        self._next_hit = next_hit
        self._arm = ArmAround(settings, clock, joints.joints, turn_s)
        self._moved = MovedPoints(arm or settings.arm, settings.plan)
        self._armed: _Armed | None = None
        self._waiting: deque[CapturedBlock] = deque()
        self._asked: machine.Prompt | None = None
        self._silent = False
        self._jumped_s = -math.inf
        self._due = {"posture": 0.0, "preview": 0.0, "joints": 0.0, "losses": 0.0, "health": 0.0}
        self._untriggered = UntriggeredPushes(board.channels, settings.plan.trigger)
        self._rate_hz = float(settings.plan.sampling.rate_hz)
        # Number, posture and roving point of every accepted hit, the last one at the end.
        self._kept = list(accepted_before)
        self._polarity = HammerPolarity(polarities_before)
        self._stopping: Stopping | None = None
        self.accepted = 0
        self.rejected = 0
        self.ended: str | None = None

    @property
    def complete(self) -> bool:
        """Whether every planned point has its accepted hits."""
        return self._state.lacking == 0

    def turn(self, now_s: float, commands: tuple[Command, ...]) -> None:
        """Do what is due."""
        for command in commands:
            self._obey(command, now_s)
        if self._is_due("posture", POSTURE_EVERY_WALL_S, now_s):
            self._source.hear()
            self._follow_posture(self._joints.reading(now_s), now_s)
        if self._board.clock_jumped_s > self._jumped_s:
            self._jumped_s = self._board.clock_jumped_s
            self.note("the board's clock jumped: hits taken meanwhile are not used", now_s)
        self._judge_blocks(now_s)
        self._report(now_s)
        if self._state.kind is PromptKind.DONE and self.ended is None and not self._waiting:
            self.ended = what_was_done(self._state)
        stopping = self._stopping
        if stopping is not None and self.ended is None:
            asked = self._state.kind is PromptKind.HIT
            under_way = asked or bool(self._waiting) or self._board.blocks_under_way > 0
            if stopping.may_end(now_s, hit_under_way=under_way):
                self.ended = stopping.reason

    def flush_losses(self) -> None:
        """Put what was lost so far into the journal."""
        self._board.count_losses(self._clock.now_s())
        for loss in self._losses.take():
            self._journal.append(encode_loss(loss))
            self._outbox.put(LossNoted(loss=loss))

    def interrupt(self, reason: str) -> None:
        """Keep what is known when the session cannot go on: the losses so far, and the reason."""
        self._mark(MarkKind.NOTE, self._clock.now_s(), f"interrupted: {reason}"[:NOTE_LENGTH])
        self.flush_losses()

    def note(self, text: str, now_s: float) -> None:
        """Tell the operator something, and keep it."""
        here = self._state.here
        self._mark(MarkKind.NOTE, now_s, text, point=here.point if here else None)
        self._outbox.put(Noted(text=text, host_s=now_s))

    def _obey(self, command: Command, now_s: float) -> None:
        state = self._state
        if isinstance(command, Ready):
            if state.kind is PromptKind.POSTURE:
                self.note("ready came before the arm was at its posture, and was not taken", now_s)
            elif state.kind is PromptKind.POINT:
                self._mark(MarkKind.POINT, now_s)
                self._change(machine.point_ready(state), now_s)
        elif isinstance(command, ToldPosture):
            self.note(self._source.take_word(command, state.posture, now_s), now_s)
        elif isinstance(command, Skip):
            self._mark(MarkKind.SKIPPED, now_s, command.reason)
            self._change(machine.skip(state), now_s)
        elif isinstance(command, Retake):
            try:
                changed = machine.retake(state, command.posture, command.point)
            except KeyError as error:
                self.note(f"retake: the plan has no {error.args[0]}", now_s)
                return
            self._change(changed, now_s)
            if changed.here is not None:
                self._mark(MarkKind.POINT, now_s, "retaken")  # it goes on here when come back to
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
        said, moved = self._moved.take(command, (point for _, _, point in self._kept))
        if not moved:
            self.note(said, now_s)
            return
        self._mark(MarkKind.NOTE, now_s, said, point=command.point.id)
        self._outbox.put(PointMoved(point=command.point.id, arm=self._moved.arm))

    def _withdraw(self, now_s: float) -> None:
        if not self._kept:
            self.note("there is no accepted hit to take back", now_s)
            return
        number, posture, point = self._kept.pop()
        self._journal.append(withdrawal(number, posture, point, now_s))
        self._polarity.drop(number)
        self.accepted -= 1
        self.rejected += 1
        self._outbox.put(HitWithdrawn(number=number, posture=posture, point=point))
        self._change(machine.withdraw(self._state, posture, point), now_s)

    def _change(self, state: SessionState, now_s: float) -> None:
        """Go to another state; hits count for it from now on, if it asks for one."""
        armed = self._armed
        if state.kind is PromptKind.HIT and state.current is not None:
            if armed is None or armed.index != state.current or armed.until_s < math.inf:
                self._armed = _Armed(index=state.current, since_s=now_s)
        elif armed is not None and armed.until_s == math.inf:
            self._armed = _Armed(index=armed.index, since_s=armed.since_s, until_s=now_s)
        if state.posture is not None and state.posture is not self._state.posture:
            self._source.begin_posture()
        self._state = state
        prompt = state.prompt
        if prompt != self._asked:
            self._asked = prompt
            self._outbox.put(Prompted(prompt=prompt, host_s=now_s, progress=state.progress))

    def _follow_posture(self, reading: JointReading, now_s: float) -> None:
        silent = reading.joints_rad is None and self._joints.rate_hz is not None
        if silent != self._silent:
            self._silent = silent
            self.note("the controller is silent" if silent else "the controller is back", now_s)
        posture = self._state.posture
        if self._asked is None:
            self._change(self._state, now_s)
        if posture is None:
            return
        off = self._arm.is_off(posture, reading)
        if self._state.kind is not PromptKind.POSTURE:
            if off:
                self._change(machine.posture_left(self._state), now_s)
        elif off is False and reading.held and self._arm.is_still(posture, now_s):
            self._mark(MarkKind.POSTURE, now_s)
            self._change(machine.posture_reached(self._state), now_s)

    def _judge_blocks(self, now_s: float) -> None:
        while (block := self._board.captured(now_s)) is not None:
            self._waiting.append(block)
            self._losses.add(
                "block", block.missing, "samples of a triggered block that never came", now_s
            )
        if self._waiting:
            self._source.hear()
        while self._waiting:
            block = self._waiting[0]
            known = self._board.clock_known(block)
            if known is None:
                return
            if not known:
                self._waiting.popleft()
                self._set_aside(block, now_s, "was taken while the board's clock jumped")
                continue
            fit = self._board.clock_fit
            # The filter shows the input as it was a group delay before.
            delay = self._board.found.dictionary.filter_group_delay_samples
            trigger_s = fit.host_s(block.info.trigger_ticks) - delay / self._rate_hz
            armed = self._armed
            if (
                armed is None
                or armed.index != self._state.current
                or not armed.since_s <= trigger_s <= armed.until_s
            ):
                self._waiting.popleft()
                self._set_aside(block, now_s, "was triggered when no hit was asked for")
                continue
            lead = block.info.trigger_sample - block.info.first_sample
            start_s = trigger_s - lead / self._rate_hz
            end_s = start_s + (block.info.length + delay) / self._rate_hz
            after = self._arm.after(block, end_s, now_s)
            if after is None:
                return
            self._waiting.popleft()
            self._judge(block, trigger_s, self._arm.before(start_s), after, now_s)

    def _set_aside(self, block: CapturedBlock, now_s: float, why: str) -> None:
        self._board.release(block.info.block_id, now_s)
        column = force_column(self._board.channels)
        peak_n = float(np.abs(block.counts[:, column]).max(initial=0))
        peak_n *= abs(self._board.channels[column].scale)
        self.note(
            f"block {block.info.block_id} (peak {peak_n:.3g} N) {why}: not used",
            now_s,
        )

    def _judge(
        self,
        block: CapturedBlock,
        trigger_s: float,
        before: JointReading,
        after: JointReading,
        now_s: float,
    ) -> None:
        state = self._state
        prompt = state.prompt
        posture = state.posture
        if posture is None:
            self._set_aside(block, now_s, "was triggered when no hit was asked for")
            return
        plan = self._settings.plan
        verdict = with_posture(
            judge_record(
                block,
                self._board.channels,
                plan.sampling,
                plan.trigger,
                self._settings.limits,
                exponential_end=plan.windows.exponential_end,
                polarity=self._polarity.known,
            ),
            self._arm.judged(before, after, posture),
        )
        hit = Hit(
            number=self._next_hit,
            posture=posture.name,
            sensor_point=prompt.sensor_point,
            hit_point=prompt.hit_point,
            hit_direction=hit_direction(self._moved.arm, posture, prompt.hit_point),
            first_sample=block.first_sample,
            trigger_sample=block.info.trigger_sample,
            trigger_host_s=trigger_s,
            counts=block.counts,
            before=before,
            after=after,
            verdict=verdict,
        )
        verdict_s = self._clock.wall_s(self._clock.now_s() - block.last_data_s)
        commit_s = self._journal.append(encode_hit(hit))
        self._board.release(block.info.block_id, now_s)
        self._next_hit += 1
        self.accepted += verdict.accepted
        self.rejected += not verdict.accepted
        self._outbox.put(
            HitJudged(
                hit=hit,
                verdict_s=verdict_s,
                commit_s=commit_s,
                clock_uncertainty_s=self._board.clock_fit.uncertainty_s(block.info.trigger_ticks),
            )
        )
        if verdict.accepted:
            self._kept.append((hit.number, hit.posture, roving_point(plan, hit)))
            if self._polarity.keep(hit.number, verdict.polarity):
                self.note(CALIBRATION + TURNED, now_s)
        self._change(machine.hit_judged(state, accepted=verdict.accepted), self._clock.now_s())

    def _report(self, now_s: float) -> None:
        if self._is_due("preview", PREVIEW_EVERY_WALL_S, now_s):
            preview = self._board.stream.preview()
            if preview is not None:
                self._outbox.put(preview)
                if told := self._untriggered.told_by(preview):
                    self.note(told, now_s)
        if self._is_due("joints", JOINTS_EVERY_WALL_S, now_s):
            self._losses.watch("can", self._source.faults, "lines that are not slcan", now_s)
            self._losses.watch("can", self._joints.lost, "frames the counter skipped", now_s)
            self._losses.watch("can", self._joints.invalid, "frames not decodable", now_s)
            self._board.count_losses(now_s)
            self._outbox.put(JointsSeen(reading=self._joints.reading(now_s)))
        if self._is_due("health", HEALTH_EVERY_WALL_S, now_s):
            self._outbox.put(health_of(self._board, self._source))
        if self._losses and self._is_due("losses", LOSSES_EVERY_WALL_S, now_s):
            self.flush_losses()

    def _is_due(self, what: str, every_wall_s: float, now_s: float) -> bool:
        if now_s < self._due[what]:
            return False
        self._due[what] = now_s + every_wall_s / self._clock.wall_s(1.0)
        return True

    def _mark(self, kind: MarkKind, now_s: float, note: str = "", point: str | None = None) -> None:
        self._journal.append(mark_of(self._state, kind, now_s, note, point))
