"""Recordings of many hits: where they are cut, what is said, and what comes of them."""

import importlib.util

import numpy as np
import pytest
from support.manifests import manifest, posture, run
from support.quick import few_quick
from support.recordings import (
    DOUBLE,
    PEAKS_N,
    RATE,
    TIMES_S,
    WRITERS,
    Long,
    recording,
    truth,
    write_npz,
    write_wav,
)

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.daq.judge_imported import judged
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.guess import guess_manifest
from armodal.protocols.foreign.inspection import inspect_file

N_HITS = len(TIMES_S)


def imported(folder, files='["r.npz"]', head="", mode="roving-response"):
    return judged(run(manifest(folder, posture(files), head=head, mode=mode)))


def said(session, words):
    return [text for text in session.warnings if words in text]


def frf_of(session):
    (frf,) = estimate_frfs(session, Superset(session.header.arm))
    return frf


@pytest.mark.parametrize("kind", few_quick(sorted(WRITERS), "csv", "h5"))
def test_a_recording_of_any_program_is_cut_into_hits(tmp_path, kind):
    if kind == "tdms" and importlib.util.find_spec("nptdms") is None:
        pytest.skip("npTDMS is an extra")
    WRITERS[kind](tmp_path / f"r.{kind}", recording(channels=2))
    session = imported(tmp_path, f'["r.{kind}"]')
    assert len(session.hits) == N_HITS
    assert [hit.number for hit in session.hits if not hit.verdict.accepted] == [DOUBLE + 1]
    assert session.hits[DOUBLE].verdict.reasons == ("double",)
    peaks = [hit.verdict.peak_n for hit in session.hits]
    assert peaks == pytest.approx(PEAKS_N, rel=0.03)  # a sample may lie beside the top
    frf = frf_of(session)
    near = (frf.freq_hz > 30.0) & (frf.freq_hz < 250.0)
    for channel in range(2):
        got, wanted = frf.values[channel, 0, near], truth(frf.freq_hz[near], channel)
        # exp(-8 * 1.75 s) of the response is cut off, and noise is 0.1 % of it.
        assert np.abs(got - wanted).max() < 5e-3 * np.abs(wanted).max()
    assert said(session, f"cut into {N_HITS} hits")


def test_a_sound_file_is_cut_too_once_its_scale_is_told(tmp_path):
    write_wav(tmp_path / "r.wav", recording(), 200.0)
    scale = "scale = { force = 200.0, response = 200.0 }"
    session = imported(tmp_path, '["r.wav"]', head=scale)
    assert len(session.accepted()) == N_HITS - 1
    assert session.hits[0].verdict.peak_n == pytest.approx(PEAKS_N[0], rel=0.03)


def test_a_reversed_hammer_is_found_in_a_recording_and_its_frf_is_the_same(tmp_path):
    write_npz(tmp_path / "r.npz", recording(sign=-1.0))
    session = imported(tmp_path)
    assert len(session.accepted()) == N_HITS - 1
    assert {hit.verdict.polarity for hit in session.hits} == {-1}
    assert said(session, f"{N_HITS} of {N_HITS} hits: the hammer's polarity is reversed")
    frf = frf_of(session)
    at = int(np.argmin(np.abs(frf.freq_hz - 60.0)))
    wanted = truth(frf.freq_hz[[at]])[0]
    assert abs(frf.values[0, 0, at] / wanted - 1.0) < 0.01


def test_touches_between_hits_are_said_and_are_no_hits(tmp_path):
    write_npz(tmp_path / "r.npz", recording(touch=1.5))
    session = imported(tmp_path)
    assert len(session.hits) == N_HITS
    (text,) = said(session, "weaker pulses")
    assert "1 weaker pulses of up to 1.5 N" in text
    assert "4.00 s" in text
    level = imported(tmp_path, head="cut = { level_n = 1.0 }")
    assert len(level.hits) == N_HITS + 1


def test_a_hit_soon_after_another_is_told_and_does_not_shorten_the_rest(tmp_path):
    times, peaks = (*TIMES_S[:2], 3.4, *TIMES_S[2:]), (*PEAKS_N[:2], 70.0, *PEAKS_N[2:])
    write_npz(tmp_path / "r.npz", recording(times=times, peaks=peaks, double=-1))
    session = imported(tmp_path)
    assert len(session.hits) == N_HITS + 1
    assert said(session, "a second hit falls into the record of those at 2.90 s")
    assert "double" in session.hits[1].verdict.reasons
    usual = 1.6  # s: between the other hits there is more
    assert all(len(hit.counts) > usual * RATE for hit in session.hits)


def test_a_hit_at_the_end_without_room_is_left_out(tmp_path):
    write_npz(tmp_path / "r.npz", recording(end_s=TIMES_S[-1] + 0.3))
    session = imported(tmp_path)
    assert len(session.hits) == N_HITS - 1
    assert said(session, "ends within the hit at 13.00 s: left out")


def test_one_hit_or_a_double_hit_is_left_whole(tmp_path):
    for double in (-1, 0):
        long = recording(times=(1.0,), peaks=(60.0,), double=double, end_s=4.0)
        write_npz(tmp_path / "r.npz", long)
        session = imported(tmp_path)
        assert [len(hit.counts) for hit in session.hits] == [4 * RATE]
        assert not said(session, "cut into")
        assert ("double" in session.hits[0].verdict.reasons) == (double == 0)


def test_the_manifest_says_how_to_cut_or_not_to(tmp_path):
    write_npz(tmp_path / "r.npz", recording())
    whole = imported(tmp_path, head="cut = false")
    assert len(whole.hits) == 1
    asked = imported(tmp_path, head="cut = { record_s = 0.8, pretrigger_s = 0.05 }")
    assert {len(hit.counts) for hit in asked.hits} == {round(0.8 * RATE)}
    assert {hit.trigger_sample - hit.first_sample for hit in asked.hits} <= {
        round(0.05 * RATE) + i for i in (-1, 0, 1)
    }
    with pytest.raises(ForeignFileError, match="cut"):
        imported(tmp_path, head="cut = { record_s = -1.0 }")


def two_hammers(folder):
    """Every hit with the hammer of its turn; the other shows 2 % of it."""
    even = recording(times=TIMES_S[::2], peaks=PEAKS_N[::2], double=-1)
    odd = recording(times=TIMES_S[1::2], peaks=PEAKS_N[1::2], double=-1)
    forces = np.concatenate([even.force + 0.02 * odd.force, odd.force + 0.02 * even.force])
    long = Long(time=even.time, force=forces, response=even.response + odd.response)
    np.savez(
        folder / "r.npz",
        time_s=long.time,
        hammer_a_n=forces[0],
        hammer_b_n=forces[1],
        acc_m_s2=long.response,
    )


def test_two_hammers_in_a_recording_are_two_references(tmp_path):
    two_hammers(tmp_path)
    looked = inspect_file(tmp_path / "r.npz")
    assert [doubt.key for doubt in looked.doubts] == ["references"]
    assert 'references = ["?", "?"]' in guess_manifest([looked], tmp_path).text
    with pytest.raises(ForeignFileError, match="2 signals are forces"):
        imported(tmp_path)
    files = '[{ path = "r.npz", references = ["7:-z", "8:-z"], responses = ["1:z"] }]'
    session = imported(tmp_path, files, mode="roving-hammer")
    assert [hit.hit_point for hit in session.hits] == ["7", "8", "7", "8", "7", "8", "7"]
    assert len(session.accepted()) == N_HITS
    frf = frf_of(session)
    assert [dof.point for dof in frf.references] == ["7", "8"]
    near = (frf.freq_hz > 30.0) & (frf.freq_hz < 250.0)
    wanted = truth(frf.freq_hz[near])
    # Both struck the same simulated structure: each reference sees it, and 2 % crosstalk is none.
    for j in range(2):
        assert np.abs(frf.values[0, j, near] - wanted).max() < 5e-3 * np.abs(wanted).max()


def test_a_matrix_with_a_hit_a_row_is_as_many_hits(tmp_path):
    one = [recording(times=(0.2,), peaks=(p,), double=-1, end_s=1.5) for p in PEAKS_N[:4]]
    np.savez(
        tmp_path / "r.npz",
        time_s=one[0].time,
        force_n=np.concatenate([long.force for long in one]),
        acc_m_s2=np.concatenate([long.response for long in one]),
    )
    session = imported(tmp_path)
    assert [hit.verdict.peak_n for hit in session.accepted()] == pytest.approx(
        PEAKS_N[:4], rel=0.03
    )
    assert said(session, "4 rows: one hit each")


def test_points_and_directions_come_from_the_names_of_channels(tmp_path):
    long = recording(channels=4)
    names = ["acc 11 x", "acc 11 y", "acc 11 z", "acc 12 -z"]
    table = np.vstack([long.time, long.force, long.response]).T
    header = ",".join(["time [s]", "force [N]", *(f"{name} [m/s^2]" for name in names)])
    np.savetxt(tmp_path / "r.csv", table, delimiter=",", header=header, comments="", fmt="%.9g")
    session = imported(tmp_path, '["r.csv"]')
    assert {hit.sensor_point for hit in session.hits} == {"11", "12"}
    frf = frf_of(session)
    assert [dof.point for dof in frf.responses] == ["11", "11", "11", "12"]
    assert frf.responses[3].direction.tolist() == [0.0, 0.0, -1.0]
