"""Manifests guessed from files alone: what goes on, and what is asked."""

import tomllib

import numpy as np
import pytest
from support.foreign_samples import accelerance, chain_file
from support.foreign_writers import lms_text, signalcalc, table
from support.manifests import hit_signals, run

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.guess import guess_manifest
from armodal.protocols.foreign.inspection import inspect_file
from armodal.protocols.foreign.manifest import load_manifest

FREQ = 0.25 * np.arange(1, 401)


def guess(folder, *names):
    return guess_manifest([inspect_file(folder / name) for name in names], folder)


def import_guess(folder, found):
    (folder / "m.toml").write_text(found.text, encoding="utf-8")
    return run(folder / "m.toml")


def write_frfs(folder, names, **more):
    for i, name in enumerate(names):
        (folder / name).write_bytes(signalcalc(FREQ, accelerance(FREQ, i % 3, 0), **more))


@pytest.mark.parametrize(
    ("names", "points"),
    [
        (["Hxysv00001.txt", "Hxysv00002.txt", "Hxysv00010.txt"], ["1", "2", "10"]),
        (["p3.txt", "p1.txt", "p2.txt"], ["3", "1", "2"]),
        (["beam 2024 point 07.txt", "beam 2024 point 08.txt"], ["7", "8"]),
        (["Point_4_CH1.txt", "Point_5_CH1.txt"], ["4", "5"]),
        (["1-2.txt", "2-1.txt"], ["1", "2"]),
        (["left.txt", "right.txt"], ["1", "2"]),
        (["a1.txt", "b1.txt"], ["1", "2"]),
    ],
)
def test_numbered_files_are_points(tmp_path, names, points):
    write_frfs(tmp_path, names)
    found = guess(tmp_path, *names)
    assert not found.doubts
    session = import_guess(tmp_path, found)
    assert [dof.point for dof in session.frfs[0].responses] == points
    assert any("one point a file" in text for text in found.guesses)


def test_two_numbers_in_a_name_are_response_and_reference(tmp_path):
    names = [f"H_{i}_{j}.txt" for i in (1, 2, 3) for j in (7, 8)]
    for name in names:
        _, i, j = name.removesuffix(".txt").split("_")
        data = signalcalc(FREQ, accelerance(FREQ, int(i) - 1, int(j) - 7))
        (tmp_path / name).write_bytes(data)
    found = guess(tmp_path, *names)
    assert any("exchange them" in text for text in found.guesses)
    frf = import_guess(tmp_path, found).frfs[0]
    assert [dof.point for dof in frf.responses] == ["1", "2", "3"]
    assert [dof.point for dof in frf.references] == ["7", "8"]
    for i in range(3):
        for j in range(2):
            want = accelerance(FREQ, i, j)
            assert np.allclose(frf.values[i, j], want, rtol=1e-6, atol=0)  # seven printed digits


def test_files_that_name_their_points_keep_them(tmp_path):
    chain_file(tmp_path / "a.uff", nodes=(4, 5, 6))
    found = guess(tmp_path, "a.uff")
    session = import_guess(tmp_path, found)
    assert [dof.point for dof in session.frfs[0].responses] == ["4", "5", "6"]
    assert any("3 points have sensors, 1 are struck" in text for text in found.guesses)


def test_what_nobody_told_is_asked_and_not_made_up(tmp_path):
    data = table([FREQ, accelerance(FREQ, 0, 0).real, accelerance(FREQ, 0, 0).imag])
    for name in ("p1.txt", "p2.txt"):
        (tmp_path / name).write_text(data)
    found = guess(tmp_path, "p1.txt", "p2.txt")
    assert {doubt.key for doubt in found.doubts} == {"form"}
    assert tomllib.loads(found.text)["form"] == "?"
    with pytest.raises(ForeignFileError, match=r"wanted every value, form still '[?]'"):
        import_guess(tmp_path, found)
    (tmp_path / "m.toml").write_text(found.text.replace('"?"\n', '"mobility"\n'))
    assert str(run(tmp_path / "m.toml").frfs[0].form) == "mobility"


def test_an_frf_that_drift_blew_up_near_zero_hertz_is_no_hit(tmp_path):
    freq = np.arange(0.0, 400.0)
    H = np.array(
        [700.0, *(accelerance(freq[1:], 0, 0) / np.abs(accelerance(freq[1:], 0, 0)).max())]
    )
    (tmp_path / "p.txt").write_text(table([freq, 1e-3 * H.real, 1e-3 * H.imag]))
    (doubt,) = guess(tmp_path, "p.txt").doubts
    assert doubt.key == "form"
    # Here the second line is the largest: what is beside it tells.
    (tmp_path / "q.txt").write_text(table([freq, np.roll(1e-3 * H.real, 1), 1e-3 * H.imag]))
    assert {doubt.key for doubt in guess(tmp_path, "q.txt").doubts} == {"kind"}
    found = guess(tmp_path, "p.txt", "q.txt")
    assert {doubt.key for doubt in found.doubts} == {"form"}
    assert found.text.count("responses") == 2


def test_complex_columns_ask_for_their_lines(tmp_path):
    rows = "\n".join(f"({h.real:.9e}{h.imag:+.9e}j)" for h in accelerance(FREQ, 0, 0))
    (tmp_path / "p.txt").write_text(rows)
    found = guess(tmp_path, "p.txt")
    assert [doubt.key for doubt in found.doubts] == ["line_spacing_hz", "form"]


def test_one_hit_is_imported_and_several_are_asked_for_their_points(tmp_path):
    t, force, responses = hit_signals()
    for i in (1, 2):
        np.save(tmp_path / f"m{i}.npy", np.vstack([t, force, responses]))
    assert len(import_guess(tmp_path, guess(tmp_path, "m1.npy")).hits) == 1
    found = guess(tmp_path, "m1.npy", "m2.npy")
    assert [doubt.key for doubt in found.doubts] == ["responses"]
    told = found.text.replace('["?"]', '["5:z"]')
    (tmp_path / "m.toml").write_text(told)
    assert [hit.sensor_point for hit in run(tmp_path / "m.toml").hits] == ["5", "5"]


def test_more_accelerations_than_a_sensor_has_are_asked_for_their_points(tmp_path):
    t, force, responses = hit_signals(channels=5)
    np.save(tmp_path / "m.npy", np.vstack([t, force, responses]))
    (doubt,) = guess(tmp_path, "m.npy").doubts
    assert doubt.key == "responses"
    assert "5 accelerations" in doubt.why


def test_three_accelerations_are_one_sensor(tmp_path):
    t, force, responses = hit_signals(channels=3)
    np.save(tmp_path / "m.npy", np.vstack([t, force, responses]))
    found = guess(tmp_path, "m.npy")
    assert not found.doubts
    assert any("one sensor's axes x, y, z" in text for text in found.guesses)


def test_several_frfs_of_a_file_are_points_in_their_order(tmp_path):
    H = np.array([accelerance(FREQ, i, 0) for i in range(3)])
    np.savez(tmp_path / "a.npz", freq=FREQ, H_accelerance=H)
    found = guess(tmp_path, "a.npz")
    assert not found.doubts
    session = import_guess(tmp_path, found)
    assert [dof.point for dof in session.frfs[0].responses] == ["1", "2", "3"]


def test_hits_and_frfs_are_not_one_posture(tmp_path):
    t, force, responses = hit_signals()
    np.save(tmp_path / "m.npy", np.vstack([t, force, responses]))
    write_frfs(tmp_path, ["a.txt"])
    with pytest.raises(ForeignFileError, match=r"got both: a\.txt hold FRFs"):
        guess(tmp_path, "m.npy", "a.txt")


def test_a_guess_finds_its_files_from_its_own_folder(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "out").mkdir()
    write_frfs(tmp_path / "data", ["größe 'a' \"b\".txt"])
    found = guess_manifest(
        [inspect_file(tmp_path / "data" / "größe 'a' \"b\".txt")], tmp_path / "out"
    )
    (tmp_path / "out" / "m.toml").write_text(found.text, encoding="utf-8")
    assert load_manifest(tmp_path / "out" / "m.toml")
    assert run(tmp_path / "out" / "m.toml").frfs


def test_what_is_guessed_of_many_files_is_one_sentence_whatever_their_names(tmp_path):
    names = ["FRF 3-2.txt", "FRF 3-4.txt", "FRF 3-5.txt"]
    for name, node in zip(names, "245", strict=True):
        frf = accelerance(FREQ, int(node) % 3, 0)
        (tmp_path / name).write_bytes(lms_text(FREQ, frf, reference=f"Point:{node}:-Z"))
    found = guess(tmp_path, *names)
    assert found.guesses == (
        "FRF 3-2.txt and 2 more: the file names the points and directions",
        "mode roving-hammer: 3 points are struck, 1 have sensors",
    )
