from __future__ import annotations

import dataclasses
import multiprocessing
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest

from daq.acquisition import run_acquisition
from daq.commands import Note, Ready, Retake, Skip, Stop, Withdraw
from daq.events import (
    Failed,
    Finished,
    HitJudged,
    HitWithdrawn,
    LossNoted,
    Noted,
    Prompted,
    SessionOpened,
)
from daq.session_machine import PromptKind
from daq.settings import AcquisitionSettings
from protocols.board.messages import encode_dictionary
from protocols.board.records import FrameType
from protocols.session.journal import load_journal, read_journal


class Run:
    """An acquisition in a thread, and its operator's end of the pipe."""

    def __init__(self, lab: Any, **changes: Any) -> None:
        settings = AcquisitionSettings(
            board_port=lab.board.name,
            can_channel=lab.controller.name,
            arm=lab.arm,
            plan=lab.plan,
            journal=lab.journal,
            still_s=0.05,
        )
        self.settings = dataclasses.replace(settings, **changes)
        self.ours, theirs = multiprocessing.Pipe()
        self.code: int | None = None

        def body() -> None:
            self.code = run_acquisition(self.settings, theirs)
            theirs.close()

        self.thread = threading.Thread(target=body)
        self.thread.start()
        self.seen: list[Any] = []
        self.read_to = 0

    def until(self, wanted: Callable[[Any], bool], timeout_s: float = 8.0) -> Any:
        for event in self.seen[self.read_to :]:
            self.read_to += 1
            if wanted(event):
                return event
        end_s = time.monotonic() + timeout_s
        while self.ours.poll(max(end_s - time.monotonic(), 0.0)):
            event = self.ours.recv()
            self.seen.append(event)
            self.read_to = len(self.seen)
            if wanted(event):
                return event
            if isinstance(event, Failed):
                pytest.fail(event.message)
        return pytest.fail(f"the event did not come; seen: {self.seen[-8:]}")

    def prompt(self, kind: PromptKind) -> Any:
        return self.until(lambda e: isinstance(e, Prompted) and e.prompt.kind is kind).prompt

    def judged(self) -> Any:
        return self.until(lambda e: isinstance(e, HitJudged)).hit

    def noted(self, words: str) -> Any:
        return self.until(lambda e: isinstance(e, Noted) and words in e.text)

    def failure(self) -> Any:
        failed = self.until(lambda e: isinstance(e, Failed))
        self.thread.join(5.0)
        assert self.code == 2
        return failed

    def ready(self) -> Any:
        self.prompt(PromptKind.POINT)
        self.ours.send(Ready())
        return self.prompt(PromptKind.HIT)

    def end(self) -> None:
        with suppress(OSError):  # it may just have ended by itself
            self.ours.send(Stop())
        self.thread.join(8.0)
        self.ours.close()
        assert not self.thread.is_alive()


@pytest.fixture
def start(lab: Any) -> Iterator[Callable[..., Run]]:
    runs: list[Run] = []

    def begin(**changes: Any) -> Run:
        runs.append(Run(lab, **changes))
        return runs[-1]

    yield begin
    for run in runs:
        run.end()


def strike(lab: Any, counts: np.ndarray) -> int:
    """Hit, once the block's whole time has passed since the prompt."""
    time.sleep(
        len(counts) / 1652.0 / lab.board.scale
    )  # the block must have been triggered after the prompt
    return lab.board.hit(counts)


def test_a_session_goes_from_posture_to_a_complete_journal(lab, start, fakes):
    run = start()
    for point in ("2", "3"):
        prompt = run.ready()
        assert (prompt.sensor_point, prompt.hit_point) == (point, "1")
        for _ in range(2):
            strike(lab, fakes["record"]())
            assert run.judged().verdict.accepted
    finished = run.until(lambda e: isinstance(e, Finished))
    assert finished.complete
    assert finished.accepted == 4
    session = load_journal(lab.journal)
    assert session.complete
    np.testing.assert_array_equal(session.hits[0].counts, fakes["record"]())
    assert lab.board.released == [1, 2, 3, 4]


def test_the_hit_is_in_the_journal_before_the_board_may_forget_it(lab, start, fakes):
    run = start()
    run.ready()
    sizes: list[int] = []
    held = lab.board.drop
    lab.board.drop = lambda kind, first: (
        sizes.append(len(load_journal(lab.journal).hits)) or False
        if kind is FrameType.RELEASE_REPLY
        else held(kind, first)
    )
    strike(lab, fakes["record"]())
    run.judged()
    run.end()
    assert sizes[0] == 1


def test_a_laboratory_whose_clock_runs_faster_is_measured_all_the_same(lab, start, fakes):
    lab.board.scale = lab.controller.scale = 16.0
    run = start(time_scale=16.0)
    run.ready()
    strike(lab, fakes["record"]())
    hit = run.judged()
    assert hit.verdict.accepted, hit.verdict
    # The fake says when it was struck, in ticks of the lab's clock: microseconds.
    assert hit.trigger_host_s == pytest.approx(lab.board.struck_s, abs=0.05)


def test_a_double_hit_is_kept_as_a_reject_and_asked_for_again(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"](second=0.4))
    assert run.judged().verdict.reasons == ("double",)
    prompt = run.prompt(PromptKind.HIT)
    assert (prompt.accepted, prompt.attempts) == (0, 1)
    run.end()
    assert not load_journal(lab.journal).hits[0].verdict.accepted


def test_lost_block_frames_are_asked_for_again(lab, start, fakes):
    run = start()
    run.ready()
    dropped: list[int] = []

    def drop_once(kind: FrameType, first: int) -> bool:
        if kind is FrameType.BLOCK_DATA and len(dropped) < 2:
            dropped.append(first)
            return True
        return False

    lab.board.drop = drop_once
    strike(lab, fakes["record"]())
    assert run.judged().verdict.accepted
    assert len(lab.board.resends) >= 1
    run.read_to = 0  # the loss may have been said before the verdict
    assert run.until(lambda e: isinstance(e, LossNoted)).loss.kind == "frame"


def test_a_lost_block_ready_is_found_by_status(lab, start, fakes):
    run = start()
    run.ready()
    dropped: list[int] = []
    lab.board.drop = lambda kind, first: (
        kind is FrameType.BLOCK_READY and not dropped and not dropped.append(1)
    )
    strike(lab, fakes["record"]())
    assert run.judged().verdict.accepted


def test_a_block_that_stays_incomplete_is_rejected_and_never_filled(lab, start, fakes):
    run = start()
    run.ready()
    lab.board.drop = lambda kind, first: kind is FrameType.BLOCK_DATA and first in lost
    n = len(fakes["record"]())
    lost: set[int] = set()
    time.sleep(n / 1652.0)
    with lab.board.lock:
        # The third of four frames of the block about to be sent never arrives.
        original = lab.board._send_block

        def mark(block_id: int, start_at: int, count: int) -> None:
            lost.add(lab.board.blocks[block_id].info.first_sample + 128)
            original(block_id, start_at, count)

        lab.board._send_block = mark
    lab.board.hit(fakes["record"]())
    hit = run.judged()
    assert "gap" in hit.verdict.reasons
    np.testing.assert_array_equal(hit.counts, fakes["record"]()[:128])


def test_a_bump_while_mounting_is_set_aside_and_said(lab, start, fakes):
    run = start()
    run.prompt(PromptKind.POINT)
    block = strike(lab, fakes["record"]())
    assert f"block {block} " in run.noted("not used").text
    run.ours.send(Ready())
    run.prompt(PromptKind.HIT)
    run.end()
    assert load_journal(lab.journal).hits == ()
    assert lab.board.released == [block]


def test_an_arm_that_moves_during_the_hit_is_noticed(lab, start, fakes):
    run = start()
    run.ready()
    time.sleep(0.2)
    lab.controller.joints_rad = lab.controller.joints_rad + np.radians(0.3)
    lab.board.hit(fakes["record"]())
    assert run.judged().verdict.reasons == ("moved",)


def test_a_hit_while_the_bus_is_silent_is_not_accepted(lab, start, fakes):
    run = start()
    run.ready()
    lab.controller.silent = True
    run.noted("silent")
    strike(lab, fakes["record"]())
    assert "stale" in run.judged().verdict.reasons
    lab.controller.silent = False
    run.noted("back")


def test_a_hit_on_an_arm_that_is_not_held_is_not_accepted(lab, start, fakes):
    run = start()
    run.ready()
    lab.controller.drive_state = 0
    strike(lab, fakes["record"]())
    assert "not-held" in run.judged().verdict.reasons


def test_leaving_the_posture_is_asked_back(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    here = lab.controller.joints_rad
    lab.controller.joints_rad = here + np.radians(2.0)
    run.prompt(PromptKind.POSTURE)
    lab.controller.joints_rad = here
    run.prompt(PromptKind.POINT)


def test_skip_and_retake_move_between_points(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.send(Skip(reason="hidden"))
    assert run.prompt(PromptKind.POINT).sensor_point == "3"
    run.ours.send(Retake(posture="test 1", point="2"))
    assert run.prompt(PromptKind.POINT).sensor_point == "2"
    run.end()
    assert "skipped: posture test 1, point 2: hidden" in load_journal(lab.journal).warnings


def test_an_interrupted_session_goes_on_where_it_was(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    run.judged()
    run.end()
    torn = lab.journal.read_bytes()
    lab.journal.write_bytes(torn + b"half a record")
    again = start(resume=True)
    opened = again.until(lambda e: isinstance(e, SessionOpened))
    assert opened.hits_before == 1
    assert again.ready().accepted == 1
    strike(lab, fakes["record"]())
    assert again.judged().number == 2
    again.end()
    assert len(load_journal(lab.journal).hits) == 2
    aside = lab.journal.with_name(lab.journal.name + ".torn-1")
    assert aside.read_bytes() == b"half a record"


def test_the_listener_going_away_ends_the_session_cleanly(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.close()
    run.thread.join(8.0)
    assert run.code == 0
    assert read_journal(lab.journal).end is not None
    run.ours, _ = multiprocessing.Pipe()


def test_roving_hammer_leaves_the_sensor_and_moves_the_hit(lab, start, fakes, hammer_plan):
    lab.plan = hammer_plan
    run = start(plan=hammer_plan)
    prompt = run.ready()
    assert (prompt.sensor_point, prompt.hit_point) == ("1", "2")
    strike(lab, fakes["record"]())
    hit = run.judged()
    # A unit vector within rounding of its three products.
    assert np.linalg.norm(hit.hit_direction) == pytest.approx(1.0, abs=1e-12)


def test_a_wrong_board_port_is_one_clear_message(lab, start):
    failed = start(board_port="/dev/there-is-no-such-port").failure()
    assert failed.kind == "PortError"
    assert "there is no such device" in failed.message
    assert not lab.journal.exists()


def test_a_device_that_is_no_board_is_one_clear_message(lab, start, monkeypatch):
    monkeypatch.setattr(lab.board, "received", lambda data: lab.board.write(b"ERROR 42\r\n\x00"))
    failed = start(reply_timeout_s=0.05).failure()
    assert "none of them a frame of the armodal board protocol" in failed.message
    assert not lab.journal.exists()


def test_a_board_that_is_mute_is_one_clear_message(lab, start):
    lab.board.mute = True
    assert "did not answer HELLO" in start(reply_timeout_s=0.05).failure().message


def test_a_dictionary_that_changes_ends_the_session_with_its_hits_safe(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    run.judged()
    with lab.board.lock:
        lab.board.dictionary_bytes = encode_dictionary(fakes["dictionary"]("other"))
    failed = run.failure()
    assert "describes itself differently" in failed.message
    assert len(load_journal(failed.journal).hits) == 1


def test_a_rebooted_board_ends_the_session(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    with lab.board.lock:
        lab.board.session += 1
    assert "has restarted" in run.failure().message


def test_an_unplugged_board_ends_the_session(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    lab.board.unplug()
    failed = run.failure()
    assert failed.kind == "DeviceLostError"
    assert "is gone" in failed.message


def test_a_silent_bus_at_the_start_is_one_clear_message(lab, start):
    lab.controller.silent = True
    failed = start(can_timeout_s=0.1).failure()
    assert failed.kind == "CanError"
    assert "no frame came" in failed.message
    assert not lab.journal.exists()


def test_an_adapter_that_will_not_listen_only_is_not_used(lab, start):
    lab.controller.refuse = b"L"
    assert "refused 'L'" in start().failure().message


def test_nothing_but_the_opening_commands_is_ever_written_to_the_bus(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    run.judged()
    run.end()
    assert lab.controller.commands == [b"C", b"S6", b"L"]


def test_an_existing_journal_is_not_overwritten(lab, start):
    lab.journal.write_bytes(b"precious")
    assert "exists already" in start().failure().message
    assert lab.journal.read_bytes() == b"precious"


def test_a_session_of_another_arm_is_not_resumed(lab, start, arm):
    run = start()
    run.prompt(PromptKind.POINT)
    run.end()
    before = lab.journal.read_bytes()
    other = dataclasses.replace(arm, sha256="0" * 64)
    failed = start(resume=True, arm=other).failure()
    assert failed.kind == "JournalError"
    assert "is a session of arm" in failed.message
    assert lab.journal.read_bytes() == before


def test_a_session_of_other_sensors_is_not_resumed(lab, start, fakes):
    run = start()
    run.prompt(PromptKind.POINT)
    run.end()
    lab.board.dictionary_bytes = encode_dictionary(fakes["dictionary"]("other"))
    assert "describes itself differently" in start(resume=True).failure().message


def test_a_hit_taken_back_stays_in_the_journal_and_counts_no_more(lab, start, fakes):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    assert run.judged().verdict.accepted
    run.ours.send(Withdraw())
    assert run.until(lambda e: isinstance(e, HitWithdrawn)).number == 1
    assert run.prompt(PromptKind.HIT).accepted == 0
    run.end()
    (hit,) = load_journal(lab.journal).hits
    assert hit.verdict.reasons == ("withdrawn",)
    again = start(resume=True)
    assert again.ready().accepted == 0


def test_nothing_to_take_back_is_said(lab, start):
    run = start()
    run.ready()
    run.ours.send(Withdraw())
    run.noted("no accepted hit")


def test_a_hit_under_way_is_kept_when_the_program_is_killed(lab, start, fakes):
    run = start()
    run.ready()
    time.sleep(len(fakes["record"]()) / 1652.0)
    run.ours.close()
    lab.board.hit(fakes["record"]())
    run.thread.join(8.0)
    assert [hit.verdict.accepted for hit in load_journal(lab.journal).hits] == [True]
    run.ours, _ = multiprocessing.Pipe()


def test_what_the_operator_notes_is_in_the_journal(lab, start):
    run = start()
    run.prompt(PromptKind.POINT)
    run.ours.send(Note(text="the hammer's tip was changed"))
    run.noted("tip was changed")
    run.end()
    assert "the hammer's tip was changed" in [m.note for m in read_journal(lab.journal).marks]
