"""What a session loop puts into the journal between hits."""

from __future__ import annotations

from armodal.daq.session_machine import SessionState
from armodal.protocols.session.journal import Mark, MarkKind, encode_mark

__all__ = ["mark_of", "what_was_done", "withdrawal"]


def mark_of(
    state: SessionState, kind: MarkKind, host_s: float, note: str = "", point: str | None = None
) -> bytes:
    """Return the MARK record of a step at the place in hand."""
    here = state.here
    if kind in {MarkKind.POINT, MarkKind.SKIPPED} and here is not None:
        point = here.point
    posture = here.posture if here else None
    return encode_mark(Mark(kind=kind, posture=posture, point=point, host_s=host_s, note=note))


def withdrawal(number: int, posture: str, point: str, host_s: float) -> bytes:
    """Return the MARK record of an accepted hit taken back."""
    return encode_mark(
        Mark(kind=MarkKind.WITHDRAWN, posture=posture, point=point, host_s=host_s, hit=number)
    )


def what_was_done(state: SessionState) -> str:
    """Say how a session ended in which nothing more is asked."""
    if state.lacking == 0:
        return "every planned point has its hits"
    return f"{state.lacking} of {len(state.progress)} planned points were skipped and lack hits"
