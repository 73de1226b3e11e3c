"""Hits: whole, torn, moved, unasked for."""

import multiprocessing
import time

import numpy as np
from support.acquisition_run import strike

from armodal.daq.commands import Ready
from armodal.daq.events import LossNoted
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board.records import FrameType
from armodal.protocols.session.journal import load_journal


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
        original = lab.board.send_block

        def mark(block_id: int, start_at: int, count: int) -> None:
            lost.add(lab.board.blocks[block_id].info.first_sample + 128)
            original(block_id, start_at, count)

        lab.board.send_block = mark
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
    # The record must lie behind the prompt, and begin before the arm moves.
    time.sleep(len(fakes["record"]()) / 1652.0)
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


def test_a_hit_under_way_is_kept_when_the_program_is_killed(lab, start, fakes):
    run = start()
    run.ready()
    time.sleep(len(fakes["record"]()) / 1652.0)
    run.ours.close()
    lab.board.hit(fakes["record"]())
    run.thread.join(8.0)
    assert [hit.verdict.accepted for hit in load_journal(lab.journal).hits] == [True]
    run.ours, _ = multiprocessing.Pipe()


def test_a_reversed_hammer_is_found_said_and_held_to(lab, start, fakes):
    run = start()
    run.ready()
    turned = fakes["record"]()
    turned[:, 0] *= -1
    strike(lab, turned)
    hit = run.judged()
    assert hit.verdict.accepted
    assert hit.verdict.polarity == -1
    run.read_to = 0
    run.noted("polarity is reversed")
    run.prompt(PromptKind.HIT)
    # The same hammer cannot turn round from one hit to the next.
    strike(lab, fakes["record"]())
    assert "swing" in run.judged().verdict.reasons
    run.end()
    again = start(resume=True)
    again.ready()
    strike(lab, fakes["record"]())
    assert "swing" in again.judged().verdict.reasons
    again.end()
    recovered = load_journal(lab.journal)
    assert [hit.verdict.polarity for hit in recovered.hits] == [-1, -1, -1]
    assert any("polarity is reversed" in text for text in recovered.warnings)
