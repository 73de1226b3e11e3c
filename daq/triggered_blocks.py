"""Triggered blocks in their order: which are hits of the point asked for, and which are not."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

from armodal.daq.arm_around import ArmAround
from armodal.daq.blocks import CapturedBlock
from armodal.daq.board_session import BoardSession
from armodal.daq.joint_source import JointSource
from armodal.daq.losses import LossTally
from armodal.daq.session_machine import PromptKind, SessionState
from armodal.protocols.session.records import JointReading

__all__ = ["HitBlock", "StrayBlock", "TriggeredBlocks"]


@dataclass(frozen=True, slots=True, kw_only=True)
class HitBlock:
    """A block that belongs to the point asked for, and the joints around it."""

    block: CapturedBlock
    trigger_s: float
    before: JointReading
    after: JointReading


@dataclass(frozen=True, slots=True, kw_only=True)
class StrayBlock:
    """A block that is no hit of the session, and why."""

    block: CapturedBlock
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Armed:
    """Which planned point hits belonged to, and in which time."""

    index: int
    since_s: float
    until_s: float = math.inf


class TriggeredBlocks:
    """What the board has captured, until clock and joints tell what it belongs to."""

    def __init__(
        self,
        board: BoardSession,
        source: JointSource,
        arm: ArmAround,
        losses: LossTally,
        rate_hz: float,
    ) -> None:
        self._board, self._source, self._arm = board, source, arm
        self._losses, self._rate_hz = losses, rate_hz
        self._waiting: deque[CapturedBlock] = deque()
        self._armed: _Armed | None = None

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def count_for(self, state: SessionState, now_s: float) -> None:
        """Hits count for the point of a state from now on, if it asks for one."""
        armed = self._armed
        if state.kind is PromptKind.HIT and state.current is not None:
            if armed is None or armed.index != state.current or armed.until_s < math.inf:
                self._armed = _Armed(index=state.current, since_s=now_s)
        elif armed is not None and armed.until_s == math.inf:
            self._armed = replace(armed, until_s=now_s)

    def collect(self, now_s: float) -> None:
        """Take in what the board has captured."""
        while (block := self._board.captured(now_s)) is not None:
            self._waiting.append(block)
            self._losses.add(
                "block", block.missing, "samples of a triggered block that never came", now_s
            )
        if self._waiting:
            self._source.hear()

    def take(self, current: int | None, now_s: float) -> HitBlock | StrayBlock | None:
        """The next block of which all is known; None if there is none yet.

        Parameters
        ----------
        current
            Index of the planned point that is asked for.
        """
        if not self._waiting:
            return None
        block = self._waiting[0]
        known = self._board.clock_known(block)
        if known is None:
            return None
        if not known:
            return self._stray("was taken while the board's clock jumped")
        fit = self._board.clock_fit
        # The filter shows the input as it was a group delay before.
        delay = self._board.found.dictionary.filter_group_delay_samples
        trigger_s = fit.host_s(block.info.trigger_ticks) - delay / self._rate_hz
        armed = self._armed
        if (
            armed is None
            or armed.index != current
            or not armed.since_s <= trigger_s <= armed.until_s
        ):
            return self._stray("was triggered when no hit was asked for")
        lead = block.info.trigger_sample - block.info.first_sample
        start_s = trigger_s - lead / self._rate_hz
        end_s = start_s + (block.info.length + delay) / self._rate_hz
        after = self._arm.after(block, end_s, now_s)
        if after is None:
            return None
        self._waiting.popleft()
        return HitBlock(
            block=block, trigger_s=trigger_s, before=self._arm.before(start_s), after=after
        )

    def _stray(self, why: str) -> StrayBlock:
        return StrayBlock(block=self._waiting.popleft(), why=why)
