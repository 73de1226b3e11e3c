"""`armodal merge`: a soft and a hard hammer, from files to one session and its modes."""

import json

import numpy as np
import pytest
from support.command import armodal
from support.recordings import MODES, recording, truth, write_npz

import armodal as armodal_api
from armodal.protocols.session.hdf5 import read_session

HAMMERS = {"soft": 8e-3, "hard": 2e-3}


def measured(folder, name, *, gain=1.0, end_s=15.2):
    """A session of two sensors; the hard hammer's recording ends a little earlier."""
    long = recording(
        channels=2,
        width_s=HAMMERS[name],
        noise=0.01,
        seed=len(name) + int(1e3 * HAMMERS[name]),
        double=-1,
        end_s=end_s,
    )
    long.force[:] *= gain
    write_npz(folder / f"{name}.npz", long)
    manifest = folder / f"{name}.toml"
    files = f'[{{ path = "{name}.npz", responses = ["1:z", "2:z"], reference = "7:-z" }}]'
    manifest.write_text(
        f'arm = "none"\nmode = "roving-response"\n[[postures]]\nname = "beam"\nfiles = {files}\n'
    )
    session = folder / f"{name}.h5"
    assert armodal("import", manifest, "--out", session).returncode == 0
    return session


@pytest.fixture
def merged(tmp_path):
    soft = measured(tmp_path, "soft")
    hard = measured(tmp_path, "hard", end_s=14.6)
    result = armodal("merge", soft, hard, "-o", tmp_path / "both.h5", "--json")
    assert result.returncode == 0, result.stderr
    return tmp_path / "both.h5", json.loads(result.stdout)


def test_a_soft_and_a_hard_hammer_make_one_session(merged):
    path, told = merged
    (row,) = told["postures"]
    assert row["disagreements"] == 0
    assert row["band_hz"][1] > 600.0  # the soft one excites up to 190 Hz
    assert sum(row["mean_weight"]) == pytest.approx(1.0)
    assert any("soft.h5 leads on" in text for text in told["warnings"])
    assert any("are cut to" in text for text in told["warnings"])
    (frf,) = read_session(path).frfs
    near = (frf.freq_hz > 20.0) & (frf.freq_hz < 250.0)
    for i in range(2):
        error = np.abs(frf.values[i, 0, near] - truth(frf.freq_hz[near], i))
        # 9 of 10 complex normal errors lie within 2.3 of their mean square.
        assert np.mean(error**2 < 2.3 * frf.variance[i, 0, near]) > 0.8


def test_its_modes_are_those_of_the_structure(merged):
    path, _ = merged
    fitted = armodal("fit", path, "--band", 20, 300, "--json")
    modes = json.loads(fitted.stdout)["modes"]
    wanted = [np.hypot(2 * np.pi * f, decay) / (2 * np.pi) for f, decay, _ in MODES]
    assert [mode["f_hz"] for mode in modes] == pytest.approx(wanted, rel=1e-4)


def test_hammers_of_other_sensitivity_are_told(tmp_path):
    soft = measured(tmp_path, "soft")
    hard = measured(tmp_path, "hard", gain=0.8)
    result = armodal("merge", soft, hard, "--out", tmp_path / "both.h5")
    assert result.returncode == 0, result.stderr
    assert "differ by a factor of 1.25" in " ".join(result.stdout.split())


def test_what_cannot_be_merged_is_one_message(tmp_path):
    soft = measured(tmp_path, "soft")
    alone = armodal("merge", soft, "--out", tmp_path / "both.h5")
    assert alone.returncode == 2
    assert "wanted two sessions" in alone.stderr
    twice = tmp_path / "twice.h5"
    twice.write_bytes(soft.read_bytes())
    same = armodal("merge", soft, twice, "--out", tmp_path / "both.h5")
    assert same.returncode == 2
    assert "the same session" in same.stderr
    over = armodal("merge", soft, soft, "--out", soft)
    assert over.returncode == 2
    assert not (tmp_path / "both.h5").exists()


def test_scripts_merge_as_the_command_does(tmp_path, merged):
    path, _ = merged
    sessions = [armodal_api.open_session(tmp_path / f"{name}.h5") for name in HAMMERS]
    (frf,) = armodal_api.frfs(armodal_api.merge(sessions))
    np.testing.assert_array_equal(frf.values, read_session(path).frfs[0].values)
