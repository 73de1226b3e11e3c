"""`armodal inspect`, and `armodal import` without a manifest, as a user runs them."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from support.command import armodal
from support.examples import examples
from support.foreign_samples import accelerance
from support.foreign_writers import signalcalc, table
from support.manifests import hit_signals

from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.journal_framing import MAGIC

FREQ = 0.25 * np.arange(1, 401)
_ROOT = Path(__file__).resolve().parents[3]
DATA = Path(os.environ.get("ARMODAL_DATA", _ROOT.parent / "shared" / "data"))
real = pytest.mark.skipif(
    not (DATA / "beam_9_files").is_dir(), reason="real measurements are not here (ARMODAL_DATA)"
)


def write_points(folder, count=3):
    names = [folder / f"H{i + 1:05d}.txt" for i in range(count)]
    for i, name in enumerate(names):
        name.write_bytes(signalcalc(FREQ, accelerance(FREQ, i, 0)))
    return names


def test_a_file_of_armodal_s_own_is_told_which_command_it_is_for(tmp_path):
    own = tmp_path / "own.h5"
    code, _, err = armodal("import", *write_points(tmp_path), "--out", own)
    assert code == 0, err
    journal = tmp_path / "own.journal"
    journal.write_bytes(MAGIC + bytes(100))
    for path, command in ((own, f"armodal fit {own}"), (journal, f"armodal recover {journal}")):
        for asked in (("inspect", path), ("import", path, "--out", tmp_path / "again.h5")):
            code, out, err = armodal(*asked)
            assert code == 2
            assert command in (out + err).replace("\n", "")
        assert not (tmp_path / "again.h5").exists()


def test_files_alone_become_a_session_and_the_manifest_that_made_it(tmp_path):
    files = write_points(tmp_path)
    code, out, err = armodal("import", *files, "--out", tmp_path / "s.h5", "--json")
    assert code == 0, err
    said = json.loads(out)
    assert said["postures"][0]["points"] == ["1", "2", "3"]
    assert said["fill_in"] == []
    assert any("one point a file" in text for text in said["guesses"])
    again = armodal("import", said["manifest"], "--out", tmp_path / "t.h5")
    assert again.returncode == 0
    one, other = (read_session(tmp_path / name).frfs[0] for name in ("s.h5", "t.h5"))
    assert np.array_equal(one.values, other.values)


def test_guesses_are_said(tmp_path):
    code, out, _ = armodal("import", *write_points(tmp_path), "--out", tmp_path / "s.h5")
    assert code == 0
    assert "guess: one point a file, 1 to 3" in out
    assert "guess: mode roving-response" in out


@pytest.mark.parametrize("as_json", [False, True])
def test_in_doubt_the_manifest_is_written_and_the_exit_code_is_2(tmp_path, as_json):
    path = tmp_path / "p1.txt"
    path.write_text(table([FREQ, accelerance(FREQ, 0, 0).real, accelerance(FREQ, 0, 0).imag]))
    more = ["--json"] if as_json else []
    code, out, err = armodal("import", path, "--out", tmp_path / "s.h5", *more)
    assert code == 2
    assert err.count("armodal:") == 1
    assert "fill in `form`" in err
    assert 'form = "?"' in (tmp_path / "s.toml").read_text()
    assert not (tmp_path / "s.h5").exists()
    if as_json:
        assert json.loads(out)["fill_in"][0]["key"] == "form"


def test_a_manifest_that_was_filled_in_is_not_overwritten(tmp_path):
    files = write_points(tmp_path)
    (tmp_path / "s.toml").write_text("# mine\n")
    code, _, err = armodal("import", *files, "--out", tmp_path / "s.h5")
    assert code == 2
    assert "there is one" in err
    assert (tmp_path / "s.toml").read_text() == "# mine\n"


def test_inspect_shows_contents_guesses_and_a_manifest(tmp_path):
    files = write_points(tmp_path)
    code, out, _ = armodal("inspect", *files)
    assert code == 0
    assert "1 x accelerance, 400 lines, 0.25 to 100 Hz" in out
    assert "Real (400 real, (m/s²)(N))" in out
    assert "[[postures]]" in out


def test_inspect_says_what_a_manifest_needs(tmp_path):
    t, force, responses = hit_signals()
    np.savez(tmp_path / "a.npz", time=t, a=force, b=responses[0])
    code, out, _ = armodal("inspect", tmp_path / "a.npz", "--json")
    assert code == 0
    (file,) = json.loads(out)["files"]
    assert file["format"] == "NPZ"
    assert [row["name"] for row in file["contents"]] == ["time", "a", "b"]
    assert [need["key"] for need in file["needs"]] == ["variables"]


@pytest.mark.parametrize("with_frfs", [False, True])
def test_inspect_proposes_no_import_of_geometry_alone(tmp_path, with_frfs):
    cards = ["    -1", "  2411"]
    for node in (1, 2):
        cards += [
            f"{node:10d}{0:10d}{0:10d}{7:10d}",
            f"{0.1 * node:25.16E}{0.0:25.16E}{0.0:25.16E}",
        ]
    (tmp_path / "points.unv").write_text("\n".join([*cards, "    -1", ""]))
    files = write_points(tmp_path, 2) if with_frfs else []
    code, out, err = armodal("inspect", tmp_path / "points.unv", *files)
    assert code == 0
    assert "nodes (2)" in out
    assert ("manifest:" in out) is with_frfs
    assert ("armodal import" in err) is with_frfs
    assert ("export FRFs or hits too" in err) is not with_frfs
    # Where there are FRFs too, their points are drawn where the geometry has them.
    assert ("points.unv" in out.partition("manifest:")[2]) is with_frfs
    if with_frfs:
        out_file = tmp_path / "s.h5"
        code, _, err = armodal("import", tmp_path / "points.unv", *files, "--out", out_file)
        assert code == 0, err


def test_inspect_of_what_cannot_be_read_is_exit_code_2_and_shows_the_rest(tmp_path):
    files = write_points(tmp_path, 1)
    (tmp_path / "bad.bin").write_bytes(bytes(range(256)))
    code, out, err = armodal("inspect", *files, tmp_path / "bad.bin", tmp_path / "none.txt")
    assert code == 2
    assert "400 lines" in out
    assert out.count("refused:") == 2
    assert "Traceback" not in out + err


@pytest.mark.parametrize("command", ["inspect", "import"])
@pytest.mark.parametrize("name", ["none.txt", ".", "empty.txt"])
def test_no_file_is_one_message(tmp_path, command, name):
    (tmp_path / "empty.txt").write_bytes(b"")
    more = ["--out", tmp_path / "s.h5"] if command == "import" else []
    code, out, err = armodal(command, tmp_path / name, *more)
    assert code == 2
    assert "Traceback" not in out + err
    assert (out + err).count("wanted") == 1


@given(
    kind=st.sampled_from(["frf", "hit"]),
    rows=st.sampled_from([3, 64, 200]),
    columns=st.integers(2, 5),
    step=st.floats(1e-5, 10.0),
    seed=st.integers(0, 2**32 - 1),
    make=st.sampled_from([np.asarray, np.abs, np.sign, lambda x: -np.abs(x), lambda x: 0.0 * x]),
    exponent=st.integers(-200, 200),
)
# The square of these is below the least number there is.
@example(kind="frf", rows=3, columns=4, step=1.0, seed=0, make=np.asarray, exponent=-162)
@settings(
    max_examples=examples(40),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_any_table_is_a_session_or_one_message(
    tmp_path, kind, rows, columns, step, seed, make, exponent
):
    numbers = make(np.random.default_rng(seed).standard_normal((rows, columns))) * 10.0**exponent
    numbers[:, 0] = step * np.arange(rows)
    (tmp_path / "a.txt").write_text(table(list(numbers.T)))
    (tmp_path / "m.toml").write_text(
        f'arm = "none"\nmode = "roving-response"\nkind = "{kind}"\nform = "mobility"\n'
        '[[postures]]\nname = "one"\nfiles = ["a.txt"]\n'
    )
    code, out, err = armodal("import", tmp_path / "m.toml", "--out", tmp_path / "s.h5")
    assert code in {0, 2}
    assert "Traceback" not in out + err
    assert err.count("armodal:") == (code == 2)


@given(
    head=st.sampled_from(
        ["", "time [s]{0}force [N]{0}acc [m/s^2]\n", "f [Hz]{0}Re{0}Im\n", "a{0}b\n"]
    ),
    delimiter=st.sampled_from(["\t", ";", " "]),
    decimal=st.sampled_from([".", ","]),
    hit=st.booleans(),
    end=st.floats(0.0, 1.0),
    change=st.none() | st.tuples(st.floats(0.0, 1.0, exclude_max=True), st.integers(0, 255)),
)
@settings(
    max_examples=examples(40),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_a_good_table_cut_or_changed_anywhere_is_a_session_or_one_message(
    tmp_path, head, delimiter, decimal, hit, end, change
):
    """All the way to the judge of hits: three columns of an FRF once ended there."""
    t, force, (response,) = hit_signals(n=512)
    H = accelerance(FREQ, 0, 0)
    columns = [t, force, response] if hit else [FREQ, H.real, H.imag]
    data = bytearray((head.format(delimiter) + table(columns, delimiter, decimal)).encode())
    if change is not None:
        data[int(change[0] * len(data))] = change[1]
    (tmp_path / "a.txt").write_bytes(data[: round(end * len(data))])
    for made in ("s.toml", "s.h5"):
        (tmp_path / made).unlink(missing_ok=True)
    code, out, err = armodal("import", tmp_path / "a.txt", "--out", tmp_path / "s.h5")
    assert code in {0, 2}
    assert "Traceback" not in out + err
    assert err.count("armodal:") == (code == 2)
    assert (tmp_path / "s.h5").exists() == (code == 0)


# Real measurements -------------------------------------------------------------------------------


@pytest.mark.long
@real
def test_nine_files_of_a_beam_are_imported_without_a_word(tmp_path):
    files = sorted((DATA / "beam_9_files").glob("*.txt"))
    code, out, err = armodal("import", *files, "--out", tmp_path / "s.h5", "--json")
    assert code == 0, err
    (posture,) = json.loads(out)["postures"]
    assert posture["points"] == [str(i) for i in range(1, 10)]
    assert posture["form"] == "accelerance"
    assert posture["lines"] == 51200
    # The header says (m/s²)(N) as a ratio; columns have seven digits.
    frf = read_session(tmp_path / "s.h5").frfs[0]
    row = next(
        line for line in files[3].read_bytes().splitlines() if line.startswith(b"1.11992187")
    )
    f_hz, re, im = (float(cell) for cell in row.split())
    at = int(np.argmin(np.abs(frf.freq_hz - f_hz)))
    assert frf.values[3, 0, at] == re + 1j * im


@real
def test_an_analyser_s_matlab_file_needs_its_form_alone(tmp_path):
    code, _, err = armodal(
        "import", DATA / "analyser_mat" / "case2.mat", "--out", tmp_path / "s.h5"
    )
    assert code == 2
    assert "fill in `form`" in err
    path = tmp_path / "s.toml"
    path.write_text(path.read_text().replace('"?" }', '"accelerance" }'))
    code, _, err = armodal("import", path, "--out", tmp_path / "s.h5")
    assert code == 0, err
    (frf,) = read_session(tmp_path / "s.h5").frfs
    assert np.isfinite(frf.coherence).all()
    # published 192.594 Hz, lines 0.3125 Hz apart
    assert abs(frf.freq_hz[np.argmax(np.abs(frf.values[0, 0]))] - 192.594) < 0.3125


# Two files ---------------------------------------------------------------------------------------


def two_files(folder, *, slower=1.0):
    t, force, (response,) = hit_signals()
    (folder / "hit force.txt").write_text(table([slower * t, force]))
    (folder / "hit acc.txt").write_text(table([t, response]))
    return folder / "hit force.txt", folder / "hit acc.txt"


def test_force_and_response_in_two_files_are_shown_and_imported_as_one(tmp_path):
    files = two_files(tmp_path)
    code, out, _ = armodal("inspect", *files, "--json")
    assert code == 0
    (shown,) = json.loads(out)["files"]
    assert (shown["file"], shown["force"]) == (str(files[1]), str(files[0]))
    code, out, err = armodal("import", *files, "--out", tmp_path / "s.h5", "--json")
    assert code == 0, err
    assert json.loads(out)["postures"][0]["hits"] == 1
    assert 'force = "hit force.txt"' in (tmp_path / "s.toml").read_text()


def test_two_files_of_other_rates_are_one_message(tmp_path):
    files = two_files(tmp_path, slower=2.0)
    code, out, err = armodal("import", *files, "--out", tmp_path / "s.h5")
    assert code == 2
    assert "Traceback" not in out + err
    assert err.count("wanted one sampling rate") == 1
    assert not (tmp_path / "s.h5").exists()
    assert not (tmp_path / "s.toml").exists()
