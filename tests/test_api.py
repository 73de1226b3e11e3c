"""What `armodal` offers to scripts does what the commands do."""

import inspect
import re
from dataclasses import fields, is_dataclass, replace

import numpy as np
import plotly.graph_objects as go
import pytest
from support.command import armodal as command
from support.foreign_samples import chain_file
from support.gap_results import made_result

import armodal
from armodal.analyzer.gap.records import PostureGap

RECORDS = [
    own
    for own in (getattr(armodal, name) for name in armodal.__all__)
    if isinstance(own, type) and is_dataclass(own)
]


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_every_attribute_of_a_record_is_described(record):
    said = inspect.getdoc(record).partition("Attributes\n----------\n")[2]
    names = re.findall(r"^([\w, ]+) : .+\n    \S", said, re.MULTILINE)
    described = [name for line in names for name in line.split(", ")]
    assert described == [field.name for field in fields(record)]


def test_a_session_becomes_frfs_and_modes(session, tmp_path):
    armodal.save_session(session, tmp_path / "session.h5")
    frf = armodal.frfs(armodal.open_session(tmp_path / "session.h5"))[0]
    model = armodal.fit_modes(frf, band_hz=(3.0, 100.0))
    assert isinstance(model, armodal.ModalModel)
    assert model.modes
    drawn = armodal.figure(model, frf=frf)
    assert [trace.name for trace in drawn.data] == ["measured", "model", "poles"]
    measured, fitted = (np.asarray(trace.y) for trace in drawn.data[:2])
    # The RMS of what a model explains differs from that measured by less than its own error.
    assert np.sqrt(np.mean((measured - fitted) ** 2)) < model.synthesis_error * measured.max()


def test_what_was_identified_predicts_and_is_drawn(session, identified):
    posture = [0.0, 30.0, 30.0, 0.0, 90.0, 0.0]
    prediction = armodal.predict(session, identified, posture)
    drawn = armodal.figure(prediction)
    assert len(drawn.data[0].x) == prediction.predicted.modes.f_hz.size
    joints = armodal.figure(identified)
    assert list(joints.data[0].x) == [joint.k_n_m_per_rad for joint in identified.joints]


def test_a_report_is_written(session, identified, tmp_path):
    first = {"frfs": identified.frfs[:1], "modal_models": identified.modal_models[:1]}
    armodal.report(session, replace(identified, **first), tmp_path / "report.html")
    assert "<html" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_frfs_and_a_gap_are_drawn(session):
    assert isinstance(armodal.figure(armodal.frfs(session)[0]), go.Figure)
    before = PostureGap(posture="test 1", held_out=True, frf_error=0.2, floor=0.01)
    nothing = made_result("named", ["payload"])
    found = replace(nothing, gap_before=(before,), gap_after=(replace(before, frf_error=0.02),))
    assert [list(bar.y) for bar in armodal.figure(found).data] == [[20.0], [2.0]]
    with pytest.raises(armodal.ArmodalError, match="no posture was compared"):
        armodal.figure(nothing)


def test_a_plan_is_the_command_s_own(tmp_path, small_search):
    """Of a search so small that it is quick: both plan with the same numbers."""
    made = armodal.plan(armodal.load_arm("viper_s650"), n_tests=2, minutes=40.0, seed=3)
    path = tmp_path / "plan.toml"
    done = command(
        "plan", "viper_s650", "--tests", "2", "--minutes", "40", "--seed", "3", "--out", str(path)
    )  # fmt: skip
    assert done.returncode == 0
    assert path.read_text(encoding="utf-8") == made.text
    assert made.minutes <= 40.0
    assert len(armodal.figure(made).data[0].y) == 2


def test_an_arm_with_meshes_is_planned_in_its_folder_and_refused_without(tmp_path):
    arm = armodal.load_arm("rv4frl")
    meshes = replace(arm, urdf_text='<robot><link><mesh filename="a.stl"/></link></robot>')
    with pytest.raises(armodal.ArmodalError, match=r"names meshes; wanted the folder"):
        armodal.plan(meshes)


def test_what_cannot_be_drawn_is_refused_with_what_can():
    with pytest.raises(armodal.ArmodalError, match=r"wanted a FrequencyResponse.*got dict"):
        armodal.figure({})


def test_files_of_another_program_become_a_session(tmp_path):
    chain_file(tmp_path / "chain.uff", lines=200)
    (tmp_path / "chain.toml").write_text(
        'arm = "none"\nmode = "roving-response"\n[[postures]]\nname = "chain"\n'
        'files = ["chain.uff"]\n',
        encoding="utf-8",
    )
    session = armodal.import_session(tmp_path / "chain.toml")
    (frf,) = armodal.frfs(session)
    assert frf.values.shape[-1] > 100


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="fit_everything"):
        armodal.fit_everything  # noqa: B018
    assert set(armodal.__all__) <= set(dir(armodal))
