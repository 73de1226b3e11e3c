"""A board that is pulled out and plugged in again: told at once, and gone on with or refused."""

import pytest
from support.acquisition_run import strike
from support.fake_devices import FakeBoard

from armodal.daq.events import HitJudged, SessionOpened
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.session.journal import load_journal, read_journal


@pytest.fixture
def plugged_again(lab):
    """The board after another boot, on another port, as an operating system gives it."""
    again = FakeBoard()
    again.session = lab.board.session + 1
    again.start()
    yield again
    again.unplug()


@pytest.fixture
def hit_and_pulled(lab, start, fakes):
    """A session with an accepted hit whose board was then pulled out; what it said at the end."""
    run = start()
    run.ready()
    for _ in range(3):  # a loaded machine may leave a hit without joint angles
        strike(lab, fakes["record"]())
        if run.judged().verdict.accepted:
            break
        run.prompt(PromptKind.HIT)
    lab.board.unplug()
    return run.failure()


def accepted(hits):
    return [hit for hit in hits if hit.verdict.accepted]


def test_it_is_told_with_what_to_do_and_the_hit_is_kept(hit_and_pulled, lab):
    assert hit_and_pulled.kind == "DeviceLostError"
    assert f"the device on {lab.board.name} is gone" in hit_and_pulled.message
    assert "check cable and power, then resume" in hit_and_pulled.message
    journal = read_journal(lab.journal)
    assert len(accepted(journal.hits)) == 1
    assert "interrupted: the device on" in journal.marks[-1].note
    assert journal.end is None


def test_on_another_port_the_session_goes_on(hit_and_pulled, plugged_again, lab, start, fakes):
    before = load_journal(lab.journal).hits
    run = start(resume=True, board_port=plugged_again.name)
    assert run.until(lambda e: isinstance(e, SessionOpened)).hits_before == len(before)
    lab.board = plugged_again
    assert run.ready().accepted == 1
    strike(lab, fakes["record"]())
    assert run.judged().number == len(before) + 1
    run.end()
    after = load_journal(lab.journal).hits
    assert [hit.number for hit in after] == list(range(1, len(before) + 2))
    for hit, kept in zip(after, before, strict=False):  # and the one taken since
        assert (hit.counts == kept.counts).all()
        assert hit.trigger_host_s == kept.trigger_host_s


def test_a_block_that_was_half_sent_when_it_was_pulled_is_no_hit(
    lab, start, fakes, plugged_again, monkeypatch
):
    run = start()
    run.ready()
    monkeypatch.setattr(lab.board, "drop", lambda kind, first: kind.name == "BLOCK_DATA")
    strike(lab, fakes["record"]())
    lab.board.unplug()
    run.failure()
    assert not [event for event in run.seen if isinstance(event, HitJudged)]
    assert load_journal(lab.journal).hits == ()
    again = start(resume=True, board_port=plugged_again.name)
    assert again.prompt(PromptKind.POSTURE).accepted == 0


def test_another_board_in_its_place_is_refused_and_the_journal_stays(
    hit_and_pulled, plugged_again, lab, start, fakes
):
    before = lab.journal.read_bytes()
    with plugged_again.lock:
        plugged_again.dictionary_bytes = encode_dictionary(fakes["dictionary"]("another board"))
    failed = start(resume=True, board_port=plugged_again.name).failure()
    assert failed.kind == "JournalError"
    assert "describes itself differently (sensors, scales or supply)" in failed.message
    assert lab.journal.read_bytes() == before


def test_a_port_whose_name_has_gone_is_told_with_the_ports_that_are_there(
    hit_and_pulled, lab, start, monkeypatch
):
    monkeypatch.setattr("armodal.daq.serial_port.find_ports", lambda: ())
    failed = start(resume=True).failure()
    assert f"cannot open port {lab.board.name}: there is no such device" in failed.message
    assert "No serial device is plugged in" in failed.message
