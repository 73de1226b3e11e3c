"""Sensitivities as a certificate tells them."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.made_run import BOARD, LAB_EVENTS, OPENED
from support.stage import Stage, play

from armodal.daq.commands import Note
from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.plant import load_plant
from armodal.protocols.errors import SessionError
from armodal.protocols.sensor_memory import KnownSensor
from armodal.tui.commands.run import run_app
from armodal.tui.screens.run.happenings import LabWanted, SensorsConfirmed, SessionWanted
from armodal.tui.screens.run.sensitivity import sensitivity_words

HAMMER, ACCELEROMETER = BOARD.dictionary.channels[:2]
IN_MV = LabWanted(board_port="a", can_channel="b", simulated=False, input_range_v=5.0)


def test_a_known_input_range_tells_the_certified_sensitivities_of_the_simulated_sensors():
    truth = load_plant("rv4frl").truth
    words = [
        sensitivity_words(channel, truth.board.range_v)
        for channel in board_dictionary(truth).channels
    ]
    # As certified in the plant file: 0.25 mV/N, and 50 mV/(m/s^2) for each axis.
    assert words == ["0.25 mV/N", *["50 mV/(m/s²)"] * 3]


def test_an_input_that_inverts_shows_a_negative_sensitivity():
    assert sensitivity_words(replace(HAMMER, scale=-HAMMER.scale), 5.0).startswith("-")


def test_an_unknown_input_range_is_never_guessed():
    assert sensitivity_words(HAMMER, None) == "0.001 N/ct"
    assert sensitivity_words(ACCELEROMETER, None) == "1e-05 m/s²/ct"


@pytest.mark.parametrize(("size", "wide"), [((80, 24), False), ((160, 45), True)])
def test_every_sensor_shows_its_sensitivity_to_be_confirmed(tmp_path, size, wide):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, LAB_EVENTS[0], IN_MV, *LAB_EVENTS[2:])
        # 5 V make 8388.6 N and 83.886 m/s^2.
        assert "0.596 mV/N" in stage.text()
        assert stage.text().count("59.6 mV/(m/s²)") == 3
        assert "with these sensitivities? Enter: yes" in stage.text()
        assert ("cal 2026-03-02" in stage.text()) == wide
        assert "--input-range" not in stage.text()
        assert stage.text().count(" % ") == 4  # the levels are still in sight
        assert max(map(len, stage.text().splitlines())) <= size[0]
        await stage.tell(pilot, SensorsConfirmed(), SessionWanted(), OPENED)
        kept = [note.text for note in stage.sent if isinstance(note, Note)]
        assert any("hammer S-hammer of 0.596 mV/N" in text for text in kept)

    play(stage, body, size)


def test_a_sensor_with_another_sensitivity_than_before_is_shown_before_it_is_confirmed(tmp_path):
    before = KnownSensor(sensitivity_mv=2.25, calibration_date="2026-03-02", used="2026-10-05")
    stage = Stage(tmp_path, known_sensors={"force S-hammer hammer": before})

    async def body(pilot):
        await stage.tell(pilot, LAB_EVENTS[0], IN_MV, *LAB_EVENTS[2:])
        assert "✗ hammer: 0.596 mV per N, and sensor S-hammer had 2.25 when it was" in stage.text()
        assert "with these sensitivities? Enter: yes" in stage.text()

    play(stage, body, (160, 45))


def test_without_an_input_range_the_screen_says_how_it_is_given(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS)
        assert "--input-range" in stage.text()
        assert "0.001 N/ct" in stage.text()

    play(stage, body, (80, 24))


@pytest.mark.parametrize("volts", [0.0, -5.0, float("nan"), float("inf")])
def test_an_input_range_that_is_none_is_refused(tmp_path, volts):
    with pytest.raises(SessionError, match="--input-range: wanted"):
        run_app(
            plan=None,
            arm="rv4frl",
            session=tmp_path / "s.journal",
            simulated=True,
            input_range_v=volts,
        )
