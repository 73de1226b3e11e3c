"""Where a session stands: steps from state to state, each kept in the journal and told."""

from __future__ import annotations

from armodal.daq.events import Noted, Prompted
from armodal.daq.joint_source import JointSource
from armodal.daq.journal_mirror import MirroredJournal
from armodal.daq.journal_writer import JournalWriter
from armodal.daq.session_machine import Prompt, SessionState
from armodal.daq.session_marks import mark_of
from armodal.daq.surroundings import EventQueue
from armodal.daq.triggered_blocks import TriggeredBlocks
from armodal.protocols.session.journal import MarkKind

__all__ = ["NOTE_LENGTH", "SessionSteps"]

NOTE_LENGTH = 4096  # of a sentence in the journal


class SessionSteps:
    """The state of a session, its marks and its prompts.

    Attributes
    ----------
    state
        Where it stands.
    """

    def __init__(
        self,
        state: SessionState,
        *,
        blocks: TriggeredBlocks,
        source: JointSource,
        journal: JournalWriter | MirroredJournal,
        outbox: EventQueue,
    ) -> None:
        self.state = state
        self._blocks, self._source = blocks, source
        self._journal, self._outbox = journal, outbox
        self._asked: Prompt | None = None

    @property
    def begun(self) -> bool:
        """Whether something has been asked for."""
        return self._asked is not None

    def change(self, state: SessionState, now_s: float) -> None:
        """Go to another state; hits count for it from now on, if it asks for one."""
        self._blocks.count_for(state, now_s)
        if state.posture is not None and state.posture is not self.state.posture:
            self._source.begin_posture()
        self.state = state
        prompt = state.prompt
        if prompt != self._asked:
            self._asked = prompt
            self._outbox.put(Prompted(prompt=prompt, host_s=now_s, progress=state.progress))

    def mark(self, kind: MarkKind, now_s: float, note: str = "", point: str | None = None) -> None:
        """Keep a step at the place in hand."""
        self._journal.append(mark_of(self.state, kind, now_s, note[:NOTE_LENGTH], point))

    def note(self, text: str, now_s: float) -> None:
        """Tell the operator something, and keep it."""
        here = self.state.here
        self._journal.append(
            mark_of(self.state, MarkKind.NOTE, now_s, text, here.point if here else None)
        )
        self._outbox.put(Noted(text=text, host_s=now_s))
