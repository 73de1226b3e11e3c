"""MATLAB files of FRFs: shapes as programs save them, and variables that cannot be meant."""

import numpy as np
import pytest
import scipy.io
from support.foreign_samples import accelerance
from support.manifests import manifest, posture, run

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.frf_records import FrfForm

FREQ = 0.25 * np.arange(1, 41)
FRF = np.array([accelerance(FREQ, i, 0) for i in range(3)])  # (responses, lines)
COHERENCE = np.random.default_rng(7).uniform(0.5, 1.0, FRF.shape)  # no two values alike


def one(folder, *, frf=FRF, body=None, **variables):
    content = {
        "freq_hz": FREQ,
        "frf": frf,
        "form": "accelerance",
        "unit": "SI",
        "responses": np.array(["1:z", "2:z", "3:z"], dtype=object),
        **variables,
    }
    scipy.io.savemat(folder / "a.mat", content)
    session = run(manifest(folder, body or posture('["a.mat"]', averages=5)))
    return session.frfs[0]


@pytest.mark.parametrize(
    ("frf", "coherence"),
    [
        (FRF, COHERENCE),
        (FRF.T, COHERENCE.T),
        (FRF[:, None], COHERENCE[:, None]),
        (FRF[:, None], COHERENCE),
    ],
    ids=["responses by lines", "lines by responses", "matrix", "matrix and table"],
)
def test_each_coherence_stays_with_its_frf(tmp_path, frf, coherence):
    found = one(tmp_path, frf=frf, coherence=coherence)
    assert np.array_equal(found.values[:, 0], FRF)
    assert np.array_equal(found.coherence[:, 0], COHERENCE)


@pytest.mark.parametrize(
    "coherence",
    [
        COHERENCE[:2],
        COHERENCE[:, :-1],
        COHERENCE.reshape(-1),
        COHERENCE.reshape(6, 20),
        COHERENCE + 0j,
    ],
    ids=["responses", "lines", "flat", "folded", "complex"],
)
def test_a_coherence_of_another_shape_is_refused(tmp_path, coherence):
    with pytest.raises(ForeignFileError, match="coherence of frf's shape") as caught:
        one(tmp_path, coherence=coherence)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("coherence", ["good", np.zeros((0, 0))], ids=["text", "empty"])
def test_a_coherence_without_numbers_is_left_out_with_a_word(tmp_path, coherence):
    scipy.io.savemat(
        tmp_path / "a.mat",
        {"freq_hz": FREQ, "frf": FRF[:1], "form": "accelerance", "coherence": coherence},
    )
    session = run(manifest(tmp_path, posture('["a.mat"]')))
    assert np.isnan(session.frfs[0].coherence).all()
    assert any("as coherence, got" in text for text in session.warnings)


@pytest.mark.parametrize("directions", ["up", np.eye(3) * 1j, np.ones((2, 3)), np.zeros((0, 0))])
def test_directions_that_are_none_are_refused(tmp_path, directions):
    with pytest.raises(ForeignFileError, match="response_directions of unit length"):
        one(tmp_path, response_directions=directions)


def test_averages_nobody_made_are_refused_unless_the_manifest_tells_them(tmp_path):
    with pytest.raises(ForeignFileError, match=r"up to 1000000 averages, the files tell 1e\+20"):
        one(tmp_path, averages=1e20, body=posture('["a.mat"]'))
    assert one(tmp_path, averages=1e20).n_hits.tolist() == [[5], [5], [5]]


def simcenter(values, *, first, step, label, unit, kind):
    """A function as Simcenter Testlab exports it: axis by first value and step, unit as a label."""
    quantity = {"unit_transformation": {"offset": 0.0, "factor": 1.0}}
    return {
        "x_values": {
            "start_value": first,
            "increment": step,
            "number_of_values": float(values.size),
            "quantity": {**quantity, "label": label},
        },
        "y_values": {"values": values[:, None], "quantity": {**quantity, "label": unit}},
        "function_record": {"name": kind, "type": kind},
    }


def test_an_axis_told_by_first_value_and_step_is_taken(tmp_path):
    function = simcenter(
        FRF[0], first=FREQ[0], step=0.25, label="Hz", unit="g/N", kind="FRF Point2/Point1"
    )
    scipy.io.savemat(tmp_path / "a.mat", {"FRF": function})
    content = read_content(tmp_path / "a.mat", Hints())
    (found,) = content.frfs
    assert np.allclose(found.freq_hz, FREQ, rtol=1e-12)
    assert np.allclose(found.values, 9.80665 * FRF[0], rtol=1e-12)
    assert found.form is FrfForm.ACCELERANCE
    # What only says how a unit is made up is not listed.
    assert not any("unit_transformation" in one.name for one in content.found)


@pytest.mark.parametrize("name", ["coherence", "cohe", "coh"])
def test_a_coherence_is_known_by_its_short_names(tmp_path, name):
    assert np.array_equal(one(tmp_path, **{name: COHERENCE}).coherence[:, 0], COHERENCE)
