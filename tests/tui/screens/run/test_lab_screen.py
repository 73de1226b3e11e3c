"""The laboratory's screen: hammer and accelerometer on a known mass."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.made_run import BOARD, LAB_EVENTS, OPENED, mass_hit
from support.stage import Stage, play
from support.teds_bits import iepe

from armodal.protocols.session.journal_payloads import CALIBRATION
from armodal.tui.screens.run.happenings import MassChosen, SensorsConfirmed, SessionWanted
from armodal.tui.screens.run.state import Phase


def test_a_known_mass_is_asked_for_and_hits_on_it_tell_the_ratio(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        await stage.tell(pilot, *LAB_EVENTS)
        await pilot.press("c")
        await pilot.pause()
        await pilot.press("2", ".", "5", "enter")
        await stage.settle(pilot)
        assert stage.app.state.mass_kg == 2.5
        assert stage.app.state.board_port == "/dev/ttyACM0"  # the digits chose no port
        await stage.tell(pilot, *[mass_hit(2.5 / 1.02)] * 3)
        # The counts are of a pair that is wrong by 2 %; coupling and rounding are far below.
        assert stage.app.state.ratio.ratio == pytest.approx(1.02, rel=2e-3)
        assert "ratio       1.02" in stage.text()
        await pilot.press("enter")
        await stage.settle(pilot)
        assert stage.app.state.mass_kg is None
        assert "ratio       1.02" in stage.text()
        assert not stage.app.state.ratio_asks  # two certificates leave that open

    play(stage, body)


def test_a_pair_of_sensors_that_is_off_is_told_confirmed_and_kept(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        hits = [mass_hit(2.0 / 1.1)] * 3
        await stage.tell(pilot, *LAB_EVENTS, SensorsConfirmed(), MassChosen(mass_kg=2.0), *hits)
        await pilot.press("c")
        await stage.settle(pilot)
        assert "every FRF comes out 10.0 % too large. Enter: go on all the same" in stage.text()
        await pilot.press("enter")
        await stage.settle(pilot)
        assert stage.app.state.phase is Phase.LAB
        assert "Enter: begin the session" in stage.text()
        await stage.tell(pilot, SessionWanted(), OPENED)
        kept = [note.text for note in stage.sent if note.text.startswith(CALIBRATION)]
        assert len(kept) == 1
        assert "1.10" in kept[0]
        assert "not applied, every FRF comes out 10.0 % too large" in kept[0]

    play(stage, body)


def test_a_sensor_that_says_otherwise_than_the_board_is_shown_before_it_is_confirmed(tmp_path):
    stage = Stage(tmp_path)

    async def body(pilot):
        hammer, *others = BOARD.dictionary.channels
        hammer = replace(hammer, serial_number="S-1", teds=iepe(0.00225, is_force=True, serial=7))
        dictionary = replace(BOARD.dictionary, channels=(hammer, *others))
        await stage.tell(pilot, *LAB_EVENTS, replace(BOARD, dictionary=dictionary))
        assert "✗ hammer: the sensor says serial number 7, the board S-1" in stage.text()
        assert "Are these sensors mounted" in stage.text()

    play(stage, body)
