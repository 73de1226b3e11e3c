"""A sound card as a board: blocks in order, gaps by the card's clock, errors in one sentence."""

import builtins
from contextlib import closing
from fractions import Fraction

import numpy as np
import pytest
from support.fake_sound import FakeSound
from support.wav_file import FRONT_END

from armodal.daq.front_end import open_front_end, open_source
from armodal.protocols.board.records import Overflow
from armodal.protocols.errors import DeviceLostError, FrontEndError, MissingPackageError
from armodal.protocols.front_end import front_end_from_text

TEXT = FRONT_END.format(file="").replace('"replay"', '"sound"')


def front_end(text=TEXT):
    return front_end_from_text(text, name="card", origin="front-end file card.toml")


@pytest.fixture
def card(monkeypatch):
    fake = FakeSound()
    monkeypatch.setitem(__import__("sys").modules, "sounddevice", fake.module)
    return fake


@pytest.fixture
def numbers():
    return np.random.default_rng(1).integers(-(2**23), 2**23, (2048, 4)).astype(np.int32)


def test_samples_come_as_the_card_made_them(tmp_path, card, numbers, time, run_link, streamed):
    path = tmp_path / "card.toml"
    path.write_text(TEXT)
    with closing(open_front_end(path, time)) as port:
        link, found = run_link(port, 48_000)
        assert found.dictionary.firmware == "sounddevice 0.5"
        card.bring(numbers[:1024])
        card.bring(numbers[1024:])
        time.now += 2048 / 48_000
        came = streamed(link)
    np.testing.assert_array_equal(np.concatenate([samples.counts for _, samples in came]), numbers)
    assert not any(header.overflow for header, _ in came)


def test_a_gap_is_as_long_as_the_card_s_clock_says(
    tmp_path, card, numbers, time, run_link, streamed
):
    path = tmp_path / "card.toml"
    path.write_text(TEXT)
    with closing(open_front_end(path, time)) as port:
        link, _ = run_link(port, 48_000)
        card.bring(numbers[:1024])
        card.bring(numbers[1024:], lost=300)
        time.now += 0.1
        came = streamed(link)
    assert next(s.first_sample for _, s in came if s.first_sample >= 1024) == 1024 + 300
    assert any(header.overflow & Overflow.ADC for header, _ in came)


def test_a_card_that_stands_still_is_lost(card, numbers):
    source = open_source(front_end())
    source.start(Fraction(48_000), 10.0)
    assert source.read(10.9) == []
    with pytest.raises(DeviceLostError, match="Line In has told no sample for 1 s: its sample"):
        source.read(11.1)


def test_inputs_are_taken_by_their_numbers(card, numbers):
    text = TEXT.replace("input = 1", "input = 9").replace("input = 2", "input = 1")
    source = open_source(front_end(text.replace("input = 9", "input = 2")))
    source.start(Fraction(48_000), 10.0)
    card.bring(numbers)
    (chunk,) = source.read(10.1)
    np.testing.assert_array_equal(chunk.counts, numbers[:, [1, 0, 2, 3]])


@pytest.mark.parametrize(
    ("rate_hz", "words"),
    [
        (Fraction(51_200, 31), "whole rates only"),
        (Fraction(51_200), "Line In does not make 51200 Hz; 44100 and 48000"),
        (Fraction(48_000), ""),
    ],
)
def test_rates_are_asked_of_the_card(card, rate_hz, words):
    refused = open_source(front_end()).rate_refusal(rate_hz)
    assert (words in refused) if words else refused == ""


def test_a_card_that_another_program_has_is_told(card):
    source = open_source(front_end())
    card.busy = True
    with pytest.raises(DeviceLostError, match="is another program using it"):
        source.start(Fraction(48_000), 0.0)


def test_a_card_that_is_none_or_lacks_an_input_is_refused(card):
    with pytest.raises(FrontEndError, match="source: wanted a sound card, got 'Line Out'"):
        open_source(front_end(TEXT.replace('source = ""', 'source = "Line Out"')))
    card.inputs = 2
    with pytest.raises(FrontEndError, match="Line In has 2 inputs, the front-end file names inp"):
        open_source(front_end())


@pytest.mark.parametrize(
    ("error", "words"),
    [(ImportError("none"), r"armodal\[sound\]"), (OSError("none"), "libportaudio2")],
)
def test_what_is_missing_is_told_with_how_to_get_it(monkeypatch, error, words):
    real = builtins.__import__

    def without(name, *rest):
        if name == "sounddevice":
            raise error
        return real(name, *rest)

    monkeypatch.delitem(__import__("sys").modules, "sounddevice", raising=False)
    monkeypatch.setattr("importlib.import_module", without)
    with pytest.raises(MissingPackageError, match=words):
        open_source(front_end())
