"""Real measurements of others, imported and fitted as a user does."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from support.command import armodal
from support.manifests import plain

from armodal.protocols.session.hdf5 import read_session

_ROOT = Path(__file__).resolve().parents[3]
DATA = Path(os.environ.get("ARMODAL_DATA", _ROOT.parent / "shared" / "data"))
real = pytest.mark.skipif(
    not (DATA / "hammer_hits_5").is_dir(), reason="real measurements are not here (ARMODAL_DATA)"
)


@real
def test_three_measured_accelerances_fit_as_the_reference_does(tmp_path):
    files = ", ".join(
        f'{{ path = "{DATA}/accelerance_3pt/p{i}.txt", responses = ["{i}:z"], '
        'reference = "1:z", form = "accelerance", line_spacing_hz = 1.0, units = "SI" }'
        for i in (1, 2, 3)
    )
    armodal("import", plain(tmp_path, f"[{files}]"), "--out", tmp_path / "s.h5")
    code, out, err = armodal("fit", tmp_path / "s.h5", "--json")
    assert code == 0, err
    modes = [mode["f_hz"] for mode in json.loads(out)["modes"]]
    # The reference is printed to 0.01 Hz; a fiftieth of the line spacing of 1 Hz on top.
    reference = [51.52, 142.18, 278.66, 460.40, 687.17, 958.54]
    assert np.allclose(modes, reference, atol=0.025)


@real
@pytest.mark.long
def test_five_measured_hits_are_all_kept_and_coherent(tmp_path):
    files = json.dumps([str(DATA / "hammer_hits_5" / f"m{i}.npy") for i in range(1, 6)])
    armodal("import", plain(tmp_path, files), "--out", tmp_path / "s.h5")
    session = read_session(tmp_path / "s.h5")
    assert len(session.accepted("chain")) == 5
    code, out, err = armodal("fit", tmp_path / "s.h5", "--band", "700", "4600", "--json")
    assert code == 0, err
    modes = np.array([mode["f_hz"] for mode in json.loads(out)["modes"]])
    # docs/real-measurements.md: where the reference has one mode of a close pair, 0.3 Hz off.
    for f_hz in (900.05, 1518.13, 2640.20, 3668.7, 4127.8, 4391.7):
        assert np.min(np.abs(modes - f_hz)) < 0.4
