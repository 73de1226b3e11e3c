"""What a session refuses to begin with, and what ends it: one clear message each."""

import dataclasses

import pytest
from support.acquisition_run import strike
from support.teds_bits import iepe

from armodal.daq.journal_writer import LAST_BYTES
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.board.records import IepeState
from armodal.protocols.session.journal import load_journal, read_journal


def test_a_wrong_board_port_is_one_clear_message(lab, start):
    failed = start(board_port="/dev/there-is-no-such-port").failure()
    assert failed.kind == "PortError"
    assert "there is no such device" in failed.message
    assert not lab.journal.exists()


def test_a_device_that_is_no_board_is_one_clear_message(lab, start, monkeypatch):
    monkeypatch.setattr(lab.board, "received", lambda data: lab.board.write(b"ERROR 42\r\n\x00"))
    failed = start(reply_timeout_s=0.05, give_up_wall_s=0.0).failure()
    assert "none of them a frame of the armodal board protocol" in failed.message
    assert not lab.journal.exists()


def test_a_board_that_is_mute_is_one_clear_message(lab, start):
    lab.board.mute = True
    assert (
        "did not answer HELLO" in start(reply_timeout_s=0.05, give_up_wall_s=0.0).failure().message
    )


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


def test_an_existing_journal_is_not_overwritten(lab, start):
    lab.journal.write_bytes(b"precious")
    assert "exists already" in start().failure().message
    assert lab.journal.read_bytes() == b"precious"


@pytest.mark.parametrize("resume", [False, True])
def test_a_journal_named_as_its_session_file_is_refused_before_anything_is_opened(
    lab, start, tmp_path, resume
):
    path = tmp_path / "test.H5"
    failed = start(journal=path, resume=resume, board_port="/dev/there-is-no-such-port").failure()
    assert failed.kind == "JournalError"
    assert "test.journal" in failed.message
    assert not list(tmp_path.iterdir())


def test_a_full_journal_ends_the_session_with_its_hits_safe(lab, start, fakes, monkeypatch):
    run = start()
    run.ready()
    strike(lab, fakes["record"]())
    assert run.judged().verdict.accepted
    with monkeypatch.context() as patch:
        patch.setattr(
            "armodal.daq.journal_writer.MAX_JOURNAL", lab.journal.stat().st_size + LAST_BYTES
        )
        strike(lab, fakes["record"]())
        failed = run.failure()
    assert failed.kind == "JournalError"
    assert "is full" in failed.message
    assert lab.board.released == [1]
    journal = read_journal(lab.journal)
    assert [hit.number for hit in journal.hits] == [1]
    assert failed.message in journal.marks[-1].note
    assert journal.end is None


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


@pytest.fixture
def other_sensor(lab, fakes):
    """The hammer's own data sheet says another serial number than the board."""
    found = fakes["dictionary"]()
    hammer = dataclasses.replace(found.channels[0], teds=iepe(0.00225, is_force=True, serial=7))
    found = dataclasses.replace(found, channels=(hammer, *found.channels[1:]))
    lab.board.dictionary_bytes = encode_dictionary(found)


def test_a_sensor_that_says_otherwise_than_the_board_is_refused(lab, start, other_sensor):
    message = start().failure().message
    assert "hammer: the sensor says serial number 7, the board 1: mount the sensors" in message
    assert not lab.journal.exists()


def test_a_sensor_that_was_confirmed_is_kept_with_the_data(lab, start, other_sensor):
    run = start(teds_confirmed=True)
    run.prompt(PromptKind.POINT)
    run.end()
    (said,) = load_journal(lab.journal).warnings
    assert said == (
        "calibration: hammer: the sensor says serial number 7, the board 1; confirmed by the "
        "operator"
    )


@pytest.mark.parametrize("state", [IepeState.OPEN, IepeState.SHORT])
def test_a_sensor_circuit_that_is_open_or_short_is_told(lab, start, fakes, state):
    found = fakes["dictionary"]()
    channels = list(found.channels)
    channels[1] = dataclasses.replace(channels[1], iepe=state)
    lab.board.dictionary_bytes = encode_dictionary(
        dataclasses.replace(found, channels=tuple(channels))
    )
    run = start()
    said = f"the board finds the sensor circuit of {channels[1].name} {state.name.lower()}: check"
    run.noted(said)
    run.end()


@pytest.fixture
def known_sensor(lab, start, tmp_path, fakes):
    """A session's settings after which its sensors are known, and how they were."""
    memory = {"sensor_memory": tmp_path / "sensors.json", "input_range_v": 5.0}
    run = start(**memory)
    run.prompt(PromptKind.POINT)
    run.end()
    lab.journal.unlink()
    found = fakes["dictionary"]()
    hammer = dataclasses.replace(found.channels[0], full_scale=10 * found.channels[0].full_scale)
    changed = dataclasses.replace(found, channels=(hammer, *found.channels[1:]))
    return memory, encode_dictionary(changed)


def test_a_sensor_with_another_sensitivity_than_before_is_refused(lab, start, known_sensor):
    memory, changed = known_sensor
    kept = memory["sensor_memory"].read_bytes()
    lab.board.dictionary_bytes = changed
    message = start(**memory).failure().message
    assert "and sensor 1 had" in message
    assert "when it was last used" in message
    assert "--accept-teds" in message
    assert not lab.journal.exists()
    assert memory["sensor_memory"].read_bytes() == kept


def test_a_confirmed_sensitivity_is_kept_with_the_data_and_remembered(lab, start, known_sensor):
    memory, changed = known_sensor
    lab.board.dictionary_bytes = changed
    run = start(**memory, teds_confirmed=True)
    run.prompt(PromptKind.POINT)
    run.end()
    (said,) = load_journal(lab.journal).warnings
    assert "and sensor 1 had" in said
    assert said.endswith("; confirmed by the operator")
    lab.journal.unlink()
    again = start(**memory)
    again.prompt(PromptKind.POINT)
    again.end()
    assert load_journal(lab.journal).warnings == ()


def test_what_is_remembered_but_damaged_is_one_clear_message(lab, start, tmp_path):
    (tmp_path / "sensors.json").write_text("{")
    failed = start(sensor_memory=tmp_path / "sensors.json", input_range_v=5.0).failure()
    assert "cannot be read; delete the file" in failed.message
    assert not lab.journal.exists()
