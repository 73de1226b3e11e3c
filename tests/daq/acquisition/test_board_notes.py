"""What the table of messages notes of a board: asked for, noted, and done without where refused."""

from dataclasses import replace

import pytest

from armodal.daq.events import Noted
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board import MESSAGES, FrameType, ReplyCode, encode_reply
from armodal.protocols.session.journal import read_journal


@pytest.fixture(autouse=True)
def _noted(monkeypatch):
    """The table with a note of the board's status."""
    row = replace(
        MESSAGES[FrameType.STATUS_REPLY], note=lambda told: f"{told.triggers_missed} missed"
    )
    monkeypatch.setitem(MESSAGES, FrameType.STATUS_REPLY, row)


def answering_the_note(board, payload):
    """Let a board answer so from the moment that its clock has been learnt."""
    others, asked = board.answer, []

    def answer(frame):
        asked.extend([frame] if frame.header.type is FrameType.STATUS else [])
        if frame.header.type is FrameType.STATUS and len(asked) == 21:
            board.send(FrameType.STATUS_REPLY, payload, tag=frame.header.tag)
        else:
            others(frame)

    board.answer = answer


def notes(run):
    run.prompt(PromptKind.POINT)
    return [event.text for event in run.seen if isinstance(event, Noted)]


def test_what_the_board_tells_is_noted_and_kept(lab, start):
    lab.board.tells[FrameType.STATUS] = replace(lab.board.status(), triggers_missed=7)
    run = start()
    assert "7 missed" in notes(run)
    run.end()
    assert "7 missed" in [mark.note for mark in read_journal(lab.journal).marks]


def test_a_board_that_does_not_know_it_is_measured_without(lab, start):
    unknown = encode_reply(ReplyCode.UNKNOWN_COMMAND, "no command of this type")
    answering_the_note(lab.board, unknown)
    assert not any("missed" in note for note in notes(start()))


def test_an_answer_that_cannot_be_read_is_told_and_measured_without(lab, start):
    answering_the_note(lab.board, encode_reply(ReplyCode.OK) + b"\x01")
    (note,) = [note for note in notes(start()) if "STATUS_REPLY" in note]
    assert "cannot be read" in note
