"""`armodal fit` as a user runs it: what it prints, its options, and what it refuses."""

import json
import re

import h5py
import numpy as np
import pytest
from support.command import armodal
from support.plain_hits import ASKEW, POLES, SHAPES, write_manifest


@pytest.fixture
def session(tmp_path):
    path = tmp_path / "session.h5"
    code, _, err = armodal("import", write_manifest(tmp_path), "--out", path)
    assert code == 0, err
    return path


def fitted(*arguments):
    code, out, err = armodal("fit", *arguments, "--json")
    assert code == 0, err
    return json.loads(out)


def test_json_holds_modes_synthesis_error_and_stabilisation(session):
    found = fitted(session)
    assert set(found) >= {"modes", "synthesis_error", "stabilisation", "warnings"}
    wanted = {"f_hz", "f_std_hz", "damping_ratio", "damping_std", "mpc", "mpd_deg"}
    assert len(found["modes"]) == 2
    for mode, pole in zip(found["modes"], POLES, strict=True):
        assert set(mode) >= wanted | {"structural", "joint_share", "shape", "modal_mass_kg"}
        assert mode["structural"] is None  # without an arm nobody can tell
        assert mode["joint_share"] is None
        # Five standard deviations as told, and 1e-4 for the sampled pulse.
        assert abs(mode["f_hz"] - abs(pole) / 2 / np.pi) < 5 * mode["f_std_hz"] + 1e-4 * abs(pole)
        error = mode["damping_ratio"] + pole.real / abs(pole)
        assert abs(error) < 5 * mode["damping_std"] + 1e-4
    assert 0.0 < found["synthesis_error"]["structure"] < 0.02
    assert any(pole["stable"] for pole in found["stabilisation"]["structure"]["poles"])
    posture = found["postures"]["structure"]
    assert "adds no damping" in posture["window"]
    assert posture["frfs"][0]["frac"] > 0.999
    assert 0.0 < posture["random_error"]["from_scatter"] < 0.1
    assert 0.0 < posture["random_error"]["from_coherence"] < 0.1


def test_an_askew_hit_of_six_is_left_out_and_the_reason_told(session):
    dropped = fitted(session)["postures"]["structure"]["hits_dropped"]
    assert [hit["hit"] for hit in dropped] == [ASKEW + 1]
    assert dropped[0]["reason"] == "unlike"
    assert "times those of the others" in dropped[0]["note"]
    code, out, _ = armodal("fit", session)
    assert code == 0
    assert f"hit {ASKEW + 1} left out" in out


def test_of_more_hits_than_needed_the_most_alike_are_kept(session):
    dropped = fitted(session, "--keep-hits", "3")["postures"]["structure"]["hits_dropped"]
    assert sorted(hit["reason"] for hit in dropped) == ["surplus", "surplus", "unlike"]


def test_windows_estimators_and_order_are_options(session):
    made = fitted(session)["postures"]["structure"]
    assert made["estimator"] == "h1"
    assert made["exponential_end"] == 0.1
    options = ("--estimator", "hv", "--exponential-end", "0.5", "--force-window", "0.02")
    found = fitted(session, *options, "--max-order", "20")
    other = found["postures"]["structure"]
    assert (other["estimator"], other["exponential_end"], other["force_s"]) == ("hv", 0.5, 0.02)
    # A window half as long in dB: ln 0.5 / ln 0.1 of the decay.
    ratio = other["window_decay_rad_s"] / made["window_decay_rad_s"]
    assert ratio == pytest.approx(np.log(0.5) / np.log(0.1))
    assert max(found["stabilisation"]["structure"]["orders"]) <= 20
    # The window moves no damping: two standard deviations of either fit and 1e-4 for the pulse.
    for a, b in zip(fitted(session)["modes"], found["modes"], strict=True):
        wide = a["damping_std"] + b["damping_std"]
        assert abs(a["damping_ratio"] - b["damping_ratio"]) < 2 * wide + 1e-4


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--exponential-end", "0"), "in \\(0, 1\\]"),
        (("--exponential-end", "nan"), "in \\(0, 1\\]"),
        (("--force-window", "-1"), "above 0 s"),
        (("--band", "90", "20"), "at least 8 lines"),
        (("--band", "20", "21"), "at least 8 lines"),
    ],
)
def test_impossible_options_are_one_message(session, options, word):
    refused(session, word, *options)


def refused(path, word, *options):
    code, out, err = armodal("fit", path, *options, "--json")
    assert code == 2
    assert not out
    assert err.startswith("armodal: ")
    assert "Traceback" not in err
    assert re.search(word, " ".join(err.split()))


# FRFs that came without hits, spoilt in the session file -----------------------------------------


@pytest.fixture
def frf_session(tmp_path):
    freq = 0.5 * np.arange(1, 200)
    s = 2j * np.pi * freq
    residue = SHAPES[:, 0] ** 2 / (2j * POLES.imag)
    H = sum(
        R / (s - p) + np.conj(R) / (s - np.conj(p)) for p, R in zip(POLES, residue, strict=True)
    )
    noise = np.random.default_rng(1).standard_normal((2, freq.size))
    values = s**2 * H + 1e-3 * (noise[0] + 1j * noise[1])
    np.savetxt(tmp_path / "p.txt", np.concatenate([[0.0], values]))
    manifest = tmp_path / "frf.toml"
    manifest.write_text(
        'arm = "none"\nmode = "roving-response"\nunits = "SI"\nform = "accelerance"\n'
        '[[postures]]\nname = "s"\nfiles = [{ path = "p.txt", responses = ["1:z"], '
        'reference = "1:z", line_spacing_hz = 0.5 }]\n'
    )
    path = tmp_path / "frf.h5"
    code, _, err = armodal("import", manifest, "--out", path)
    assert code == 0, err
    return path


def spoil(path, name, change):
    with h5py.File(path, "r+") as file:
        group = file["session/frf_001"]
        data = group[name][()]
        new = change(data)
        attributes = dict(group[name].attrs)
        del group[name]
        group[name] = new
        group[name].attrs.update(attributes)


def one_line(path):
    for name in ("values", "magnitude", "coherence", "variance", "freq_hz"):
        spoil(path, name, lambda data: data[..., :1])


def put(index, value):
    def change(data):
        data[..., index] = value
        return data

    return change


def test_impossible_windows_are_told_where_there_are_no_hits_to_be_windowed(frf_session):
    refused(frf_session, "in \\(0, 1\\]", "--exponential-end", "2")
    refused(frf_session, "above 0 s, got inf", "--force-window", "inf")


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda path: spoil(path, "values", put(40, np.nan)), "not finite"),
        (lambda path: spoil(path, "values", put(40, np.inf)), "not finite"),
        (lambda path: spoil(path, "values", np.zeros_like), "zero"),
        (one_line, "at least 8 lines"),
        (lambda path: spoil(path, "freq_hz", put(5, 1.0)), "rise"),
        (lambda path: spoil(path, "freq_hz", put(5, np.nan)), "finite"),
        (lambda path: spoil(path, "form", lambda _: np.bytes_("inertance")), "receptance"),
        (lambda path: spoil(path, "coherence", put(7, 1.3)), "coherence"),
    ],
    ids=["nan", "inf", "zero", "one line", "order", "nan line", "form", "coherence"],
)
def test_frfs_that_cannot_be_fitted_are_one_message(frf_session, change, word):
    change(frf_session)
    refused(frf_session, word)


def test_a_session_cut_at_any_byte_is_one_message(frf_session, tmp_path):
    data = frf_session.read_bytes()
    for end in (0, 7, 100, 2000, len(data) // 2, len(data) - 1):
        cut = tmp_path / "cut.h5"
        cut.write_bytes(data[:end])
        refused(cut, "cut.h5")


def test_options_about_hits_are_said_to_be_void_for_given_frfs(frf_session):
    found = fitted(frf_session, "--estimator", "h2")
    assert any("averaged elsewhere" in text for text in found["warnings"])
    assert found["postures"]["s"]["estimator"] is None
