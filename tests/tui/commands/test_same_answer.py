"""The same data give the same modes, directly and through our own files."""

import json
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.command import armodal
from support.manifests import manifest, posture, run
from support.plain_hits import write_manifest
from support.simulated_frfs import record

from armodal.protocols.foreign.export_uff import posture_uff
from armodal.protocols.foreign.mat_write import write_mat, write_npz
from armodal.protocols.foreign.uff_write import write_uff

TEXT_DIGITS = 1e-11  # a universal file in text has twelve digits


def write(frf, arm, path, *, binary):
    if path.suffix == ".mat":
        write_mat(frf, path)
    elif path.suffix == ".npz":
        write_npz(frf, path)
    else:
        content, _ = posture_uff(frf, arm, modes=(), software="armodal test")
        write_uff(content, path, binary=binary)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """A plain structure with the points 1 to 4 at no place."""
    folder = tmp_path_factory.mktemp("plain")
    lines = np.arange(1.0, 51.0)
    frf = record(np.ones((4, 1, 1)) * lines * (1.0 + 1.0j), lines)
    responses = [f"{i + 1}:z" for i in range(4)]
    np.savez(folder / "a.npz", frf=frf.values[:, 0], freq_hz=frf.freq_hz, form="accelerance")
    files = json.dumps("a.npz")
    body = posture(f"[{{ path = {files}, responses = {json.dumps(responses)} }}]", hit_point="1")
    return run(manifest(folder, body)).header.arm


@settings(max_examples=25, deadline=None)
@given(
    name=st.sampled_from(["a.uff", "b.uff", "a.mat", "a.npz"]),
    seed=st.integers(0, 2**32 - 1),
    n_resp=st.integers(1, 4),
    size=st.floats(-9.0, 9.0),
    decay=st.sampled_from([0.0, 2.5]),
    alike=st.booleans(),
)
def test_variance_and_averages_come_back(arm, name, seed, n_resp, size, decay, alike):
    rng = np.random.default_rng(seed)
    shape = (n_resp, 1, 50)
    values = 10.0**size * (rng.normal(size=shape) + 1j * rng.normal(size=shape))
    hits = np.full((n_resp, 1), 3) if alike else rng.integers(1, 9, (n_resp, 1))
    frf = replace(
        record(values, np.arange(1.0, 51.0) * 0.75, decay=decay),
        variance=np.abs(values) ** 2 * 10.0 ** rng.uniform(-9.0, 1.0, shape),
        coherence=rng.uniform(0.0, 1.0, shape),
        n_hits=hits,
    )
    frf = replace(frf, references=(replace(frf.references[0], point="1"),))
    # The record numbers axes x, y, z; at one axis a point they are all along z here.
    frf = replace(frf, responses=tuple(replace(dof, label="z") for dof in frf.responses))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        write(frf, arm, path / name, binary=name == "b.uff")
        (back,) = run(manifest(path, posture([name]))).frfs
    assert np.allclose(back.values, frf.values, rtol=TEXT_DIGITS)
    assert np.allclose(back.variance, frf.variance, rtol=TEXT_DIGITS)
    assert np.allclose(back.coherence, frf.coherence, rtol=TEXT_DIGITS, atol=TEXT_DIGITS)
    assert np.allclose(back.freq_hz, frf.freq_hz, rtol=1e-9)  # ten digits of the step
    assert np.array_equal(back.n_hits, frf.n_hits)
    assert back.decay_rad_s == decay


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hits")
    armodal("import", write_manifest(folder), "--out", folder / "s.h5")
    return folder / "s.h5"


def modes_of(session):
    code, out, _ = armodal("fit", session, "--json")
    assert code == 0
    names = ("f_hz", "f_std_hz", "damping_ratio", "damping_std", "mpc", "dof")
    return np.array([[mode[name] for name in names] for mode in json.loads(out)["modes"]])


@pytest.fixture(scope="module")
def direct(measured):
    return modes_of(measured)


@pytest.mark.parametrize(
    "ending", ["uff", "npz", *(pytest.param(e, marks=pytest.mark.long) for e in ("unv", "mat"))]
)
def test_modes_agree_to_rounding_through_every_format(measured, direct, tmp_path, ending):
    there, back = tmp_path / f"x.{ending}", tmp_path / "back.h5"
    assert armodal("export", measured, "--out", there, "--no-modes")[0] == 0
    assert armodal("import", there, "--out", back)[0] == 0
    assert len(direct) == 2
    # Rounding of the text, times the condition of a least-squares fit.
    assert np.allclose(modes_of(back), direct, rtol=1e-6)
