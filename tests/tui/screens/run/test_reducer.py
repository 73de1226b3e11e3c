from __future__ import annotations

import dataclasses

import pytest
from support.made_run import (
    ARM,
    AT_HIT,
    AT_POINT,
    AT_POSTURE,
    BOARD,
    HIT_EVENTS,
    LAB_EVENTS,
    PLAN,
    SESSION_EVENTS,
    after,
    finished,
    fresh,
    judged,
    preview,
    prompted,
    reading,
    trial,
)
from support.shipped_screens import SHIPPED_SCREENS

from armodal.daq.events import DeviceTrouble, Failed, HitWithdrawn, LossNoted, Noted
from armodal.daq.session_machine import hit_judged
from armodal.protocols.session.journal import Mark, MarkKind
from armodal.protocols.session.records import Loss
from armodal.tui.screens.run.happenings import (
    LabEnded,
    LabWanted,
    ProcessGone,
    SafeConfirmed,
    SensorsConfirmed,
    SessionWanted,
    Tick,
)
from armodal.tui.screens.run.keys import works
from armodal.tui.screens.run.operator_screen import needed_screen
from armodal.tui.screens.run.reducer import KEPT_PREVIEWS
from armodal.tui.screens.run.state import SILENT_AFTER_S, Phase, RunState, begin_state
from armodal.tui.screens.run.views.lab import devices_text, next_step


def loss(kind: str, count: int) -> LossNoted:
    return LossNoted(loss=Loss(kind=kind, count=count, first_sample=None, host_s=0.0, note=""))


def shown(state: RunState) -> str:
    return needed_screen(state, SHIPPED_SCREENS)


def test_the_steps_follow_the_prompts():
    state = after(fresh(), *SESSION_EVENTS)
    assert shown(state) == "posture"
    state = after(state, prompted(AT_POINT))
    assert shown(state) == "posture"  # until the operator has confirmed that it is safe
    state = after(state, SafeConfirmed())
    assert shown(state) == "point"
    assert shown(after(state, prompted(AT_HIT))) == "hit"


def test_safety_is_not_confirmed_of_an_arm_that_is_not_held():
    state = after(fresh(), *SESSION_EVENTS, reading(held=False), prompted(AT_POINT))
    assert not after(state, SafeConfirmed()).safe


def test_safety_is_not_confirmed_of_an_arm_whose_angles_are_unknown():
    state = after(fresh(), *SESSION_EVENTS, reading(None), prompted(AT_POINT))
    assert not after(state, SafeConfirmed()).safe


def test_an_arm_let_go_takes_the_confirmation_back_at_once():
    state = after(fresh(), *HIT_EVENTS)
    assert shown(state) == "hit"
    let_go = after(state, reading(held=False))
    assert not let_go.safe
    assert shown(after(let_go, reading())) == "posture"  # it has to be confirmed again


def test_a_short_gap_of_the_bus_is_said_and_a_long_one_takes_the_confirmation_back():
    state = after(fresh(), *HIT_EVENTS, reading(None))
    assert state.held is None
    assert state.safe
    late = Tick(now_s=state.now_s + SILENT_AFTER_S + 0.1)
    assert not after(state, late, reading(None)).safe


def test_joints_that_are_no_longer_told_of_become_unknown():
    state = after(fresh(), *SESSION_EVENTS)
    assert state.posture_known
    later = after(state, Tick(now_s=state.now_s + SILENT_AFTER_S + 0.1))
    assert not later.posture_known
    assert later.joints is None


def test_leaving_the_posture_takes_the_confirmation_back():
    state = after(fresh(), *HIT_EVENTS, prompted(AT_POSTURE), prompted(AT_HIT))
    assert shown(state) == "posture"


def test_progress_is_that_of_the_acquisition():
    session = hit_judged(AT_HIT, accepted=True)
    state = after(fresh(), *HIT_EVENTS, judged(1), prompted(session))
    assert state.progress[0].accepted == 1
    assert state.last_hit is not None
    assert state.last_hit.hit.number == 1


def test_a_hit_taken_back_is_remembered_until_the_next():
    state = after(
        fresh(), *HIT_EVENTS, judged(1), HitWithdrawn(number=1, posture="test 1", point="1")
    )
    assert state.withdrawn == {1}
    assert state.last_taken_back == 1
    assert after(state, judged(2)).last_taken_back is None


def test_losses_add_up_by_kind():
    state = after(fresh(), loss("can", 2), loss("stream", 5), loss("can", 3))
    assert dict(state.losses) == {"can": 5, "stream": 5}


def test_a_lost_board_is_no_longer_shown_as_there():
    state = after(fresh(), *LAB_EVENTS, DeviceTrouble(device="board", message="gone"))
    assert state.board is None
    assert dict(state.troubles) == {"board": "gone"}
    back = after(state, DeviceTrouble(device="board", message=None), BOARD)
    assert not back.troubles
    assert back.board is BOARD


def test_other_sensors_have_to_be_confirmed_anew():
    state = after(fresh(), *LAB_EVENTS, SensorsConfirmed())
    assert state.sensors_confirmed
    assert after(state, BOARD).sensors_confirmed  # the same once more
    other = dataclasses.replace(
        BOARD, dictionary=dataclasses.replace(BOARD.dictionary, board_id="board-8")
    )
    assert not after(state, other).sensors_confirmed


def test_the_end_of_the_watch_is_not_the_end_of_the_session():
    state = after(fresh(), *LAB_EVENTS, SessionWanted(), finished())
    assert state.phase is Phase.OPENING
    assert after(state, *SESSION_EVENTS[-3:], finished()).phase is Phase.ENDED


def test_a_process_that_dies_without_a_word_is_a_failure_unless_the_session_had_ended():
    assert after(fresh(), *HIT_EVENTS, ProcessGone()).phase is Phase.FAILED
    assert after(fresh(), *HIT_EVENTS, finished(), ProcessGone()).phase is Phase.ENDED


def test_a_failure_says_so_and_the_session_can_be_gone_on_with():
    failed = Failed(message="gone", kind="DeviceLostError", journal="x")
    state = after(fresh(), *HIT_EVENTS, failed)
    assert state.phase is Phase.FAILED
    assert not state.safe
    again = after(state, SessionWanted(), *SESSION_EVENTS[-3:])
    assert shown(again) == "posture"
    assert again.failed is None


def test_what_is_kept_for_the_live_view_is_bounded():
    state = after(fresh(), *(preview(i) for i in range(3 * KEPT_PREVIEWS)), *[trial()] * 30)
    assert len(state.previews) == KEPT_PREVIEWS
    assert len(state.trials) < 30


def test_notes_are_kept():
    assert after(fresh(), Noted(text="the bus is silent", host_s=1.0)).notes == (
        "the bus is silent",
    )


def test_a_state_never_changes_in_place():
    state = fresh()
    with pytest.raises(dataclasses.FrozenInstanceError):
        state.now_s = 1.0


def test_points_skipped_before_are_shown_as_skipped_before_the_session_is_opened():
    posture = PLAN.postures[0]
    skipped = Mark(kind=MarkKind.SKIPPED, posture=posture.name, point=posture.points[0], host_s=1.0)
    state = begin_state(ARM, PLAN, earlier_marks=(skipped,), earlier_end="left")
    assert [p.skipped for p in state.progress[:2]] == [True, False]


def test_what_devices_say_after_their_laboratory_has_ended_is_not_believed():
    gone = Failed(
        message="the device is gone; check cable and power", kind="DeviceLostError", journal="j"
    )
    ended = LabEnded(why="the simulated laboratory ended by itself: IndexError")
    for events in ([ended, gone], [gone, ended]):
        failed = after(fresh(), *HIT_EVENTS, *events).failed
        assert failed is not None
        assert (failed.message, failed.kind, failed.journal) == (ended.why, "LabEnded", "j")


def test_a_laboratory_that_has_ended_is_told_before_the_session_and_can_be_started_again():
    state = after(fresh(), *LAB_EVENTS, LabEnded(why="it ended: IndexError"))
    words, _ = next_step(state)
    assert "ended by itself" in words
    assert "cable" not in words
    shown = devices_text(state).plain
    assert "IndexError" in shown
    assert "cable" not in shown
    assert works("simulate", state, overview=False)
    assert not works("hand", state, overview=False)
    wanted = LabWanted(board_port="b", can_channel="c", simulated=True)
    assert after(state, wanted).lab_ended is None
