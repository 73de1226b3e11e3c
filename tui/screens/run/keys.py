"""Which keys do something now; the footer shows only these."""

from __future__ import annotations

from armodal.daq.session_machine import PromptKind
from armodal.tui.screens.run.state import Phase, RunState
from armodal.tui.screens.run.trials import suggested_level_n

__all__ = ["ACTIONS", "works"]

ACTIONS = (
    "go_on",
    "angles",
    "move",
    "hand",
    "simulate",
    "take_trigger",
    "mass",
    "retake",
    "skip",
    "undo",
    "call",
    "again",
)


def works(action: str, state: RunState, *, overview: bool) -> bool:
    """Return whether an action does something now; actions not of the session always do."""
    in_session = state.phase is Phase.SESSION
    in_lab = state.phase is Phase.LAB
    answers = {
        "go_on": overview or _enter_works(state),
        "angles": state.awaits_word and not overview,
        "move": in_session and _at_point(state) and state.hand_doing is None and not overview,
        "hand": state.simulated
        and state.lab_ended is None
        and (in_session or in_lab)
        and not overview,
        "simulate": in_lab
        and (not state.board_port or state.lab_ended is not None)
        and not state.lab_starting,
        "take_trigger": in_lab and not state.resuming and suggested_level_n(state) is not None,
        "mass": in_lab and state.board is not None,
        "retake": in_session and not overview,
        "skip": in_session and not overview,
        "undo": in_session and any(p.accepted for p in state.progress),
        "call": in_session,
        "again": state.phase is Phase.FAILED or _paused(state),
    }
    return answers.get(action, True)


def _enter_works(state: RunState) -> bool:
    if state.phase is Phase.LAB:
        return state.board is not None and state.angles_will_come
    if state.phase is Phase.ENDED:
        return state.session_file is not None and state.file_problem is None
    prompt = state.prompt
    if state.phase is not Phase.SESSION or prompt is None:
        return False
    if prompt.kind is PromptKind.POSTURE:
        return state.awaits_word
    return not state.safe or (prompt.kind is PromptKind.POINT and state.hand_doing is None)


def _at_point(state: RunState) -> bool:
    """Whether the operator stands at a point, and nothing is mounted yet."""
    return state.prompt is not None and state.prompt.kind is PromptKind.POINT


def _paused(state: RunState) -> bool:
    finished = state.finished
    return state.phase is Phase.ENDED and finished is not None and not finished.complete
