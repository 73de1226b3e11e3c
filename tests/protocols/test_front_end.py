import pytest
from support.wav_file import FRONT_END

from armodal.protocols.board.records import IepeState
from armodal.protocols.errors import FrontEndError
from armodal.protocols.front_end import front_end_from_text, load_front_end

REPLAY = FRONT_END.format(file="hits.wav")
NI = """
format = "armodal-front-end-1"
device = "ni"
source = "cDAQ1Mod1"
range_v = 5.0
[[channels]]
name = "hammer"
quantity = "force"
input = "ai0"
sensitivity_mv = 2.25
iepe_ma = 2.0
[[channels]]
name = "acc_z"
quantity = "acceleration"
input = "ai1"
sensitivity_mv = -10.2
iepe_ma = 2.0
"""


def read(text):
    return front_end_from_text(text, name="bench", origin="front-end file bench.toml")


def test_a_full_scale_is_that_of_the_largest_count():
    found = read(REPLAY)
    hammer, *_, acc_z = found.channels
    assert hammer.scale == pytest.approx(1e-4)  # 838.8607 N over 2^23 - 1 counts
    assert (acc_z.scale < 0.0, acc_z.full_scale) == (True, 83.88607)
    assert (hammer.unit, acc_z.unit) == ("N", "m/s^2")
    assert found.inputs == (1, 2, 3, 4)


def test_a_sensitivity_and_the_range_make_the_scale():
    hammer, acc_z = read(NI).channels
    assert hammer.full_scale == pytest.approx(5.0 / 2.25e-3)
    assert acc_z.full_scale == pytest.approx(5.0 / 10.2e-3)
    assert acc_z.scale < 0.0
    assert hammer.iepe is IepeState.OK


@pytest.mark.parametrize(
    ("text", "change", "to", "words"),
    [
        (REPLAY, 'device = "replay"', "device = 7", "device: wanted a string, got 7"),
        (REPLAY, 'source = "hits.wav"', "", "source: wanted the file to replay"),
        (REPLAY, "input = 2", "input = 1", r"channels\[1\].input: wanted each once, got 1"),
        (REPLAY, "input = 2", 'input = "ai0"', "wanted a number, 1 for the first, got 'ai0'"),
        (REPLAY, '"acc_x"', '"hammer"', r"channels\[1\].name: wanted each once, got 'hammer'"),
        (REPLAY, "full_scale = 838.8607", "", r"channels\[0\]: wanted full_scale or sens.*neither"),
        (REPLAY, "full_scale = 838.8607", "full_scale = 0.0", "that is not 0"),
        (REPLAY, "2026-03-02", "in March", "wanted a date, as 2026-03-02, got 'in March'"),
        (REPLAY, "full_scale = 838.8607", "sensitivity_mv = 2.0", "range_v: wanted the inputs'"),
        (NI, 'input = "ai0"', "input = 1", "wanted a name of the device's, as ai0, got 1"),
        (NI, "sensitivity_mv = 2.25", "full_scale = 2.0", "sensitivity_mv: wanted mV per N"),
        (NI, "sensitivity_mv = 2.25", "sensitivity = 2.0", "unknown key 'sensitivity' .*_mv"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(text, change, to, words):
    assert change in text
    with pytest.raises(FrontEndError, match=words):
        read(text.replace(change, to, 1))


def test_a_file_to_replay_lies_beside(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(REPLAY)
    assert load_front_end(path).source == str(tmp_path / "hits.wav")
    path.write_text(REPLAY.replace("hits.wav", "../hits.wav"))
    with pytest.raises(FrontEndError, match="source: wanted the name of a file beside it"):
        load_front_end(path)
