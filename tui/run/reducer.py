"""Events in, state out: the whole behaviour of the screens, without a screen."""

from __future__ import annotations

from dataclasses import replace

from daq.events import (
    BoardFound,
    DeviceTrouble,
    Failed,
    Finished,
    Health,
    HitJudged,
    HitWithdrawn,
    JointsSeen,
    LossNoted,
    Noted,
    Preview,
    Prompted,
    SessionOpened,
    TrialHit,
)
from daq.session_machine import PromptKind
from tui.run.happenings import (
    HandAtWork,
    HandIdle,
    Happening,
    LabWanted,
    PortsFound,
    ProcessGone,
    SafeConfirmed,
    SensorsConfirmed,
    SessionFileReady,
    SessionWanted,
    Tick,
    TriggerChosen,
)
from tui.run.state import Phase, RunState

__all__ = ["reduce"]

KEPT_PREVIEWS = 40  # four seconds
KEPT_TRIALS = 8
KEPT_NOTES = 50


def reduce(state: RunState, event: Happening) -> RunState:
    """Return the state after an event."""
    reduced = _of_app(state, event)
    if reduced is None:
        reduced = _of_session(state, event)
    if reduced is None:
        reduced = _of_lab(state, event)
    if reduced is None:
        return state
    return _safe_only_while_held(reduced)


def _of_lab(state: RunState, event: Happening) -> RunState | None:
    match event:
        case BoardFound():
            same = state.board is not None and state.board.dictionary == event.dictionary
            confirmed = state.sensors_confirmed and same
            return replace(state, board=event, sensors_confirmed=confirmed)
        case DeviceTrouble(device=device, message=message):
            others = tuple(pair for pair in state.troubles if pair[0] != device)
            now = () if message is None else ((device, message),)
            lost_board = device == "board" and message is not None
            return replace(
                state,
                troubles=others + now,
                board=None if lost_board else state.board,
                previews=() if lost_board else state.previews,
            )
        case Health():
            return replace(state, health=event)
        case Preview():
            return replace(state, previews=(*state.previews, event)[-KEPT_PREVIEWS:])
        case JointsSeen(reading=reading):
            return replace(state, reading=reading, reading_at_s=state.now_s)
        case TrialHit():
            return replace(state, trials=(*state.trials, event)[-KEPT_TRIALS:])
        case LossNoted(loss=loss):
            return replace(state, losses=_counted(state.losses, loss.kind, loss.count))
        case _:
            return None


def _of_session(state: RunState, event: Happening) -> RunState | None:
    match event:
        case SessionOpened(warnings=warnings):
            notes = (*state.notes, *warnings)[-KEPT_NOTES:]
            return replace(state, opened=event, phase=Phase.SESSION, notes=notes)
        case Prompted(prompt=prompt, progress=progress):
            left = prompt.kind is PromptKind.POSTURE
            return replace(state, prompt=prompt, progress=progress, safe=state.safe and not left)
        case HitJudged():
            return replace(state, hits=(*state.hits, event), last_taken_back=None)
        case HitWithdrawn(number=number):
            return replace(state, withdrawn=state.withdrawn | {number}, last_taken_back=number)
        case Noted(text=text):
            return replace(state, notes=(*state.notes, text)[-KEPT_NOTES:])
        case Finished() if state.phase is Phase.SESSION:
            return replace(state, finished=event, phase=Phase.ENDED, safe=False)
        case Failed():
            return replace(state, failed=event, phase=Phase.FAILED, safe=False)
        case _:
            return None


def _of_app(state: RunState, event: Happening) -> RunState | None:
    match event:
        case Tick(now_s=now_s):
            return replace(state, now_s=now_s)
        case PortsFound(ports=ports, board_choice=board):
            return replace(state, ports=ports, board_choice=board)
        case LabWanted():
            return replace(
                state,
                phase=Phase.LAB,
                board_port=event.board_port,
                can_channel=event.can_channel,
                simulated=event.simulated,
                board=None,
                troubles=(),
                previews=(),
                trials=(),
                health=None,
            )
        case TriggerChosen(plan=plan):
            return replace(state, plan=plan, trials=())
        case SensorsConfirmed():
            return replace(state, sensors_confirmed=state.board is not None)
        case SessionWanted():
            return replace(
                state,
                phase=Phase.OPENING,
                failed=None,
                finished=None,
                previews=(),
                troubles=(),
                safe=False,
                reading=None,
            )
        case SafeConfirmed():
            asked = state.prompt is not None and state.prompt.kind is not PromptKind.POSTURE
            return replace(state, safe=asked and state.held is True)
        case HandAtWork(doing=doing):
            return replace(state, hand_doing=doing, hand_trouble=None)
        case HandIdle(trouble=trouble):
            return replace(state, hand_doing=None, hand_trouble=trouble)
        case ProcessGone() if state.phase in {Phase.ENDED, Phase.FAILED}:
            return state
        case ProcessGone():
            return replace(state, phase=Phase.FAILED, failed=_gone(state), safe=False)
        case SessionFileReady(path=path, problem=problem):
            return replace(state, session_file=path, file_problem=problem)
        case _:
            return None


def _safe_only_while_held(state: RunState) -> RunState:
    """Take the operator's word back when the arm is no longer known to be held."""
    return replace(state, safe=False) if state.safe and state.held is not True else state


def _counted(
    losses: tuple[tuple[str, int], ...], kind: str, count: int
) -> tuple[tuple[str, int], ...]:
    totals = dict(losses)
    totals[kind] = totals.get(kind, 0) + count
    return tuple(totals.items())


def _gone(state: RunState) -> Failed:
    journal = state.opened.journal if state.opened else None
    return Failed(
        message="the acquisition process ended without a word",
        kind="ProcessGone",
        journal=journal,
    )
