"""A sound file as a board: every sample as it is in the file, at its time; hits are judged."""

import math
from contextlib import closing

import numpy as np
import pytest
from support.acquisition_run import Run
from support.wav_file import FRONT_END, write_replay

from armodal.daq.commands import Ready
from armodal.daq.front_end import open_front_end
from armodal.daq.session_machine import PromptKind
from armodal.protocols.errors import (
    BoardRefusedError,
    DeviceLostError,
    ForeignFileError,
    FrontEndError,
)
from armodal.protocols.session.journal import load_journal

RATE_HZ = 1652
HIT_EVERY = 800  # samples


@pytest.fixture
def numbers():
    return np.random.default_rng(1).integers(-(2**23), 2**23, (1000, 4)).astype(np.int32)


def test_every_sample_comes_as_it_is_in_the_file(tmp_path, numbers, time, run_link, streamed):
    with closing(open_front_end(write_replay(tmp_path, numbers), time)) as port:
        link, found = run_link(port, RATE_HZ)
        assert found.dictionary.board_id == "replay:replay"
        assert [c.serial_number for c in found.dictionary.channels] == ["H-1", "", "", ""]
        begun_s, came = time.now, []
        while len(came) < 15:
            time.now += 0.01
            came += streamed(link)
    counts = np.concatenate([samples.counts for _, samples in came])
    np.testing.assert_array_equal(counts, numbers[: len(counts)])
    for header, samples in came:
        ready_s = begun_s + samples.first_sample / RATE_HZ
        assert header.ticks == pytest.approx(1e6 * ready_s, abs=2.0)  # ticks are rounded, twice


def test_at_its_end_the_device_is_lost(tmp_path, numbers, time, run_link):
    with closing(open_front_end(write_replay(tmp_path, numbers), time)) as port:
        link, _ = run_link(port, RATE_HZ)
        time.now += 1000 / RATE_HZ
        link.pump()
        with pytest.raises(DeviceLostError, match=r"hits.wav has come to its end, after 0.605 s"):
            link.pump()


def test_another_rate_is_refused_with_the_file_s_own(tmp_path, numbers, time, run_link):
    with (
        closing(open_front_end(write_replay(tmp_path, numbers), time)) as port,
        pytest.raises(BoardRefusedError, match=r"hits\.wav was recorded at 1652 Hz"),
    ):
        run_link(port, 2000)


@pytest.mark.parametrize(
    ("name", "data", "kind", "words"),
    [
        ("other.wav", None, FrontEndError, "other.wav: wanted a sound file beside"),
        ("other.wav", b"RIFF", ForeignFileError, "wanted a sound file with its format"),
    ],
)
def test_a_file_that_is_none_is_refused(tmp_path, time, name, data, kind, words):
    path = tmp_path / "replay.toml"
    path.write_text(FRONT_END.format(file=name))
    if data is not None:
        (tmp_path / name).write_bytes(data)
    with pytest.raises(kind, match=words):
        open_front_end(path, time)


def test_an_input_that_the_file_lacks_is_refused(tmp_path, numbers, time):
    path = write_replay(tmp_path, numbers[:, :3])
    with pytest.raises(FrontEndError, match="has 3 channels, the front-end file names input 4"):
        open_front_end(path, time)


def hits(record, n):
    """Quiet, then hits; the acceleration's last axis is upside down, as its full scale is."""
    one = np.zeros((HIT_EVERY, 4))
    one[: len(record)] = record
    sign = np.array([1, 1, 1, -1])
    noise = np.random.default_rng(2).normal(0.0, 100.0, (n * HIT_EVERY, 4))
    return np.rint(np.concatenate([one * sign] * n) + noise).astype(np.int32)


def test_a_session_is_captured_from_a_file(lab, fakes, tmp_path):
    """The same judge, journal and screens as for a board; the pre-trigger comes from the ring."""
    lab.board.unplug()
    record = fakes["record"](pretrigger=64)
    path = write_replay(tmp_path, hits(record, 40))
    run = Run(lab, board_port=str(path))
    run.prompt(PromptKind.POINT)
    run.ours.send(Ready())
    hit = run.judged()
    run.end()
    assert hit.verdict.reasons == ()
    assert hit.verdict.peak_n == pytest.approx(
        200.0 * math.cos(math.pi / 10), abs=20.0
    )  # half a sample off the top
    (kept,) = load_journal(lab.journal).hits[:1]
    lead = kept.trigger_sample - kept.first_sample
    assert lead == lab.plan.sampling.pretrigger
    # Sample for sample the file's own, wherever in it the hit was.
    whole = hits(record, 40)
    np.testing.assert_array_equal(
        kept.counts, whole[kept.first_sample : kept.first_sample + len(kept.counts)]
    )


def test_a_device_without_a_driver_is_refused_with_those_there_are(tmp_path, numbers, time):
    path = write_replay(tmp_path, numbers)
    path.write_text(path.read_text().replace('"replay"', '"hbk"'))
    with pytest.raises(FrontEndError, match=r"wanted one of ni, .*replay, sound.*, got hbk"):
        open_front_end(path, time)
