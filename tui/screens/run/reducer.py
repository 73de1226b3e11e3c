"""Events in, state out: the whole behaviour of the screens, without a screen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from armodal.daq.events import (
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
    PointMoved,
    Preview,
    Prompted,
    SessionOpened,
    TrialHit,
)
from armodal.daq.preview import PREVIEW_EVERY_WALL_S
from armodal.daq.session_machine import PromptKind
from armodal.tui.screens.run.happenings import (
    HandAtWork,
    HandIdle,
    Happening,
    LabEnded,
    LabStarting,
    LabWanted,
    MassChosen,
    PortsFound,
    ProcessGone,
    RatioConfirmed,
    RatioFound,
    SafeConfirmed,
    SensorsConfirmed,
    SessionFileReady,
    SessionWanted,
    Tick,
    TriggerChosen,
)
from armodal.tui.screens.run.state import SILENT_AFTER_S, Phase, RunState

__all__ = ["reduce"]

KEPT_PREVIEWS = round(4.0 / PREVIEW_EVERY_WALL_S)  # four seconds
KEPT_TRIALS = 8
KEPT_NOTES = 50


def reduce(state: RunState, event: Happening) -> RunState:
    """Return the state after an event."""
    handler = _HANDLERS.get(type(event))
    return state if handler is None else _safe_only_while_held(handler(state, event))


def _board_found(state: RunState, event: BoardFound) -> RunState:
    same = state.board is not None and state.board.dictionary == event.dictionary
    return replace(state, board=event, sensors_confirmed=state.sensors_confirmed and same)


def _device_trouble(state: RunState, event: DeviceTrouble) -> RunState:
    others = tuple(pair for pair in state.troubles if pair[0] != event.device)
    now = () if event.message is None else ((event.device, event.message),)
    lost_board = event.device == "board" and event.message is not None
    return replace(
        state,
        troubles=others + now,
        board=None if lost_board else state.board,
        previews=() if lost_board else state.previews,
    )


def _joints_seen(state: RunState, event: JointsSeen) -> RunState:
    return replace(state, reading=event.reading, reading_at_s=state.now_s)


def _trial_hit(state: RunState, event: TrialHit) -> RunState:
    if state.mass_kg is None:
        return replace(state, trials=(*state.trials, event)[-KEPT_TRIALS:])
    return replace(state, mass_hits=(*state.mass_hits, event)[-KEPT_TRIALS:])


def _mass_chosen(state: RunState, event: MassChosen) -> RunState:
    if event.mass_kg is None:
        return replace(state, mass_kg=None)
    return replace(state, mass_kg=event.mass_kg, mass_hits=(), ratio=None)


def _loss_noted(state: RunState, event: LossNoted) -> RunState:
    totals = dict(state.losses)
    totals[event.loss.kind] = totals.get(event.loss.kind, 0) + event.loss.count
    return replace(state, losses=tuple(totals.items()))


def _session_opened(state: RunState, event: SessionOpened) -> RunState:
    notes = (*state.notes, *event.warnings)[-KEPT_NOTES:]
    return replace(state, opened=event, phase=Phase.SESSION, notes=notes)


def _prompted(state: RunState, event: Prompted) -> RunState:
    left = event.prompt.kind is PromptKind.POSTURE
    return replace(
        state, prompt=event.prompt, progress=event.progress, safe=state.safe and not left
    )


def _withdrawn(state: RunState, event: HitWithdrawn) -> RunState:
    return replace(state, withdrawn=state.withdrawn | {event.number}, last_taken_back=event.number)


def _finished(state: RunState, event: Finished) -> RunState:
    if state.phase is not Phase.SESSION:
        return state  # the watch before the session has ended
    return replace(state, finished=event, phase=Phase.ENDED, safe=False)


def _lab_wanted(state: RunState, event: LabWanted) -> RunState:
    return replace(
        state,
        phase=Phase.LAB,
        board_port=event.board_port,
        can_channel=event.can_channel,
        input_range_v=event.input_range_v,
        simulated=event.simulated,
        lab_starting=False,
        lab_ended=None,
        board=None,
        troubles=(),
        previews=(),
        trials=(),
        health=None,
    )


def _lab_ended(state: RunState, event: LabEnded) -> RunState:
    """What devices say once their laboratory is gone is only what followed."""
    failed = state.failed
    if failed is not None:
        failed = replace(failed, message=event.why, kind="LabEnded")
    return replace(state, lab_ended=event.why, failed=failed, board=None, reading=None)


def _failed(state: RunState, event: Failed) -> RunState:
    if state.lab_ended is not None:
        event = replace(event, message=state.lab_ended, kind="LabEnded")
    return replace(state, failed=event, phase=Phase.FAILED, safe=False)


def _session_wanted(state: RunState, event: SessionWanted) -> RunState:
    del event
    return replace(
        state,
        phase=Phase.OPENING,
        failed=None,
        finished=None,
        prompt=None,
        previews=(),
        troubles=(),
        safe=False,
        reading=None,
    )


def _safe_confirmed(state: RunState, event: SafeConfirmed) -> RunState:
    del event
    asked = state.prompt is not None and state.prompt.kind is not PromptKind.POSTURE
    return replace(state, safe=asked and state.held is True)


def _hand_idle(state: RunState, event: HandIdle) -> RunState:
    did = state.hand_did if event.trouble else state.hand_doing
    return replace(
        state,
        hand_doing=None,
        hand_did=did,
        lab_starting=state.lab_starting and event.trouble is None,
    )


def _gone(state: RunState, event: ProcessGone) -> RunState:
    if state.phase in {Phase.ENDED, Phase.FAILED}:
        return state
    failed = Failed(
        message=event.last_word or "the acquisition process ended without a word",
        kind="ProcessGone",
        journal=state.opened.journal if state.opened else None,
    )
    return replace(state, phase=Phase.FAILED, failed=failed, safe=False)


# What each event does to the state; the rest is left alone.
_HANDLERS: dict[type, Callable[[RunState, Any], RunState]] = {
    Tick: lambda state, event: replace(state, now_s=event.now_s),
    PortsFound: lambda state, event: replace(
        state, ports=event.ports, board_choice=event.board_choice
    ),
    LabStarting: lambda state, _: replace(state, lab_starting=True),
    LabEnded: _lab_ended,
    LabWanted: _lab_wanted,
    BoardFound: _board_found,
    DeviceTrouble: _device_trouble,
    Health: lambda state, event: replace(state, health=event),
    Preview: lambda state, event: replace(
        state, previews=(*state.previews, event)[-KEPT_PREVIEWS:]
    ),
    JointsSeen: _joints_seen,
    TrialHit: _trial_hit,
    MassChosen: _mass_chosen,
    RatioFound: lambda state, event: replace(state, ratio=event.calibration, ratio_confirmed=False),
    RatioConfirmed: lambda state, _: replace(state, ratio_confirmed=True),
    TriggerChosen: lambda state, event: replace(state, plan=event.plan, trials=()),
    SensorsConfirmed: lambda state, _: replace(state, sensors_confirmed=state.board is not None),
    LossNoted: _loss_noted,
    SessionWanted: _session_wanted,
    SessionOpened: _session_opened,
    Prompted: _prompted,
    SafeConfirmed: _safe_confirmed,
    HitJudged: lambda state, event: replace(state, hits=(*state.hits, event), last_taken_back=None),
    HitWithdrawn: _withdrawn,
    Noted: lambda state, event: replace(state, notes=(*state.notes, event.text)[-KEPT_NOTES:]),
    PointMoved: lambda state, event: replace(state, arm=event.arm),
    Finished: _finished,
    Failed: _failed,
    ProcessGone: _gone,
    SessionFileReady: lambda state, event: replace(
        state, session_file=event.path, file_problem=event.problem
    ),
    HandAtWork: lambda state, event: replace(state, hand_doing=event.doing),
    HandIdle: _hand_idle,
}


def _safe_only_while_held(state: RunState) -> RunState:
    """Take the operator's word back when the arm is let go, or unknown for too long.

    A gap in the bus shorter than a second is said, and does not ask for the word again.
    """
    if state.held is True:
        return replace(state, held_at_s=state.now_s)
    if not state.safe:
        return state
    unknown_s = float("inf") if state.held_at_s is None else state.now_s - state.held_at_s
    if state.held is False or unknown_s > SILENT_AFTER_S:
        return replace(state, safe=False)
    return state
