"""What a session tells by the clock: preview, joints, health of the lines, losses."""

from __future__ import annotations

from collections.abc import Callable

from armodal.daq.board_session import BoardSession
from armodal.daq.clock import Clock
from armodal.daq.events import JointsSeen, LossNoted
from armodal.daq.health import HEALTH_EVERY_WALL_S, health_of
from armodal.daq.joint_source import JointSource
from armodal.daq.journal_mirror import MirroredJournal
from armodal.daq.journal_writer import JournalWriter
from armodal.daq.losses import LossTally
from armodal.daq.preview import PREVIEW_EVERY_WALL_S
from armodal.daq.surroundings import EventQueue
from armodal.daq.untriggered import UntriggeredPushes
from armodal.protocols.session.journal import encode_loss

__all__ = ["DueTimes", "SessionReports"]

JOINTS_EVERY_WALL_S = 0.2
LOSSES_EVERY_WALL_S = 1.0


class DueTimes:
    """When what is done every so often was last done."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._due: dict[str, float] = {}

    def is_due(self, what: str, every_wall_s: float, now_s: float) -> bool:
        """Whether it is time, at first at once; it counts as done then."""
        if now_s < self._due.get(what, 0.0):
            return False
        self._due[what] = now_s + every_wall_s / self._clock.wall_s(1.0)
        return True


class SessionReports:
    """Tells the operator and the journal how the lines are."""

    def __init__(
        self,
        *,
        clock: Clock,
        board: BoardSession,
        joints: JointSource,
        losses: LossTally,
        journal: JournalWriter | MirroredJournal,
        outbox: EventQueue,
        untriggered: UntriggeredPushes,
        note: Callable[[str, float], None],
    ) -> None:
        self._clock, self._board, self._source = clock, board, joints
        self._losses, self._journal, self._outbox = losses, journal, outbox
        self._untriggered, self._note = untriggered, note
        self._due = DueTimes(clock)

    def tell(self, now_s: float) -> None:
        """Tell what is due."""
        if self._due.is_due("preview", PREVIEW_EVERY_WALL_S, now_s):
            preview = self._board.stream.preview()
            if preview is not None:
                self._outbox.put(preview)
                if told := self._untriggered.told_by(preview):
                    self._note(told, now_s)
        if self._due.is_due("joints", JOINTS_EVERY_WALL_S, now_s):
            joints = self._source.joints
            self._losses.watch("can", self._source.faults, "lines that are not slcan", now_s)
            self._losses.watch("can", joints.lost, "frames the counter skipped", now_s)
            self._losses.watch("can", joints.invalid, "frames not decodable", now_s)
            self._board.count_losses(now_s)
            self._outbox.put(JointsSeen(reading=joints.reading(now_s)))
        if self._due.is_due("health", HEALTH_EVERY_WALL_S, now_s):
            self._outbox.put(health_of(self._board, self._source))
        if self._losses and self._due.is_due("losses", LOSSES_EVERY_WALL_S, now_s):
            self.flush_losses()

    def flush_losses(self) -> None:
        """Put what was lost so far into the journal."""
        self._board.count_losses(self._clock.now_s())
        for loss in self._losses.take():
            self._journal.append(encode_loss(loss))
            self._outbox.put(LossNoted(loss=loss))
