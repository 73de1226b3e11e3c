"""The report of a plain structure says in words what was found, and shows it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from markupsafe import escape
from support.plain_structure import F_HZ, plate_session

from armodal.analyzer.modal import drift_told, fit_modes
from armodal.analyzer.report import write_plain_report
from armodal.analyzer.report.plain_figures import (
    auto_mac_figure,
    stabilisation_figure,
    synthesis_figure,
)
from armodal.analyzer.report.plain_words import answer, open_questions
from armodal.analyzer.report.shape_figures import (
    has_geometry,
    moving_shapes_figure,
    shape_bars_figure,
)


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    return plate_session(tmp_path_factory.mktemp("plate"))


@pytest.fixture(scope="module")
def model(plate):
    return fit_modes(plate.frfs[0])


@pytest.fixture(scope="module")
def moved(plate, moving):
    frf, model = moving
    return replace(plate, frfs=(frf,)), model


def written(session, model, folder):
    path = folder / "r.html"
    write_plain_report(session, session.frfs, [model], path)
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def html(plate, model, tmp_path_factory):
    return written(plate, model, tmp_path_factory.mktemp("report"))


def test_the_page_begins_with_the_answer(html):
    assert "3 modes from 30 to 110 Hz, found in 6 FRFs at 6 points" in html
    assert html.index("3 modes from") < html.index("<table")


def test_every_mode_stands_in_the_table_with_its_deviation(html, model):
    for mode in model.modes:
        assert f"<td>{mode.f_hz:.3f}</td><td>{mode.f_std_hz:.2g}</td>" in html
        assert f"<td>{mode.mpc:.4f}</td>" in html


def test_all_parts_are_there_and_nothing_is_loaded(html, plate):
    for title in ("FRFs and the model", "Shapes", "AutoMAC", "Stabilisation", "Indicators"):
        assert re.search(rf"<(h3|button)[^>]*>[^<]*{title}", html)
    assert plate.header.session_id in html
    assert plate.header.plan.sha256 in html
    assert 'name="viewport"' in html
    assert not re.search(r"<(script|link|img|iframe)[^>]*\s(src|href)=", html)


def test_warnings_of_the_session_are_shown_and_never_run(plate, model, tmp_path):
    evil = "<script>alert(1)</script>"
    html = written(replace(plate, warnings=(evil,)), model, tmp_path)
    assert evil not in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in html


def test_modes_that_move_are_told_with_points_and_cause(moved, tmp_path):
    session, model = moved
    html = written(session, model, tmp_path)
    told = drift_told(model)
    assert told
    assert "moved between measurements" in html
    assert "Modes that move" in html
    for one in told:
        assert f"<td>{one.lowest[1]:.3f}</td><td>{one.lowest[0]}</td>" in html
        assert escape(one.words) in html


def test_where_nothing_moves_the_page_says_so(html):
    assert "No mode moved from point to point" in html
    assert "Modes that move" not in html


def test_a_single_frf_has_no_shapes_and_says_so(plate, tmp_path):
    frf = plate.frfs[0]
    one = replace(
        frf,
        values=frf.values[:1],
        coherence=frf.coherence[:1],
        variance=frf.variance[:1],
        n_hits=frf.n_hits[:1],
        responses=frf.responses[:1],
    )
    session = replace(plate, frfs=(one,))
    html = written(session, fit_modes(one), tmp_path)
    assert "there are no shapes" in html
    assert "AutoMAC" not in html


def test_no_mode_at_all_is_an_answer(plate, tmp_path):
    rng = np.random.default_rng(0)
    frf = plate.frfs[0]
    noise = rng.normal(size=frf.values.shape) + 1j * rng.normal(size=frf.values.shape)
    nothing = replace(frf, values=noise)
    model = fit_modes(nothing)
    assert not model.modes
    assert "No mode was found" in answer(nothing, model)[0]
    assert "No mode was found" in written(replace(plate, frfs=(nothing,)), model, tmp_path)


def test_a_peak_without_its_mode_is_an_open_question(plate, model):
    frf = plate.frfs[0]
    lacking = replace(model, modes=(model.modes[0], model.modes[2]))
    assert any("a mode may be missing near 61" in text for text in open_questions(frf, lacking))
    assert not any("may be missing" in text for text in open_questions(frf, model))


def test_the_synthesis_lies_on_the_measurement(plate, model):
    figure = synthesis_figure(plate.frfs[0], model)
    measured, synthesis = (np.asarray(trace.y) for trace in figure.data[:2])
    # 1 % noise of the RMS; off resonance the noise is the larger part.
    high = measured > measured.mean()
    assert np.allclose(measured[high], synthesis[high], rtol=0.05)


def test_the_stabilisation_has_a_column_of_stable_poles_at_every_mode(plate, model):
    figure = stabilisation_figure(plate.frfs[0], model, (model.stabilisation,))
    stable = np.asarray(next(t for t in figure.data if t.name == "stable pole").x)
    for f in F_HZ:
        assert np.count_nonzero(np.abs(stable - f) < 0.005 * f) >= 5


def test_the_auto_mac_is_one_on_its_diagonal(model):
    values = np.asarray(auto_mac_figure(model).data[0].z)
    assert np.allclose(np.diag(values), 1.0)
    assert np.allclose(values, values.T)


def test_shapes_move_on_the_geometry_where_there_is_one(plate, model):
    arm = plate.header.arm
    assert has_geometry(arm, model)
    figure = moving_shapes_figure(arm, model)
    assert len(figure.frames) == 16 * len(model.modes)
    first, half = (np.asarray(figure.frames[k].data[0].z, dtype=float) for k in (0, 8))
    # Half a cycle later the same motion is turned round: the plate lies at z = 0.
    assert np.allclose(first[np.isfinite(first)], -half[np.isfinite(half)])
    assert np.nanmax(np.abs(first)) > 0.05


def test_without_a_geometry_there_are_bars_with_deviations(tmp_path):
    session = plate_session(tmp_path, places=False)
    model = fit_modes(session.frfs[0])
    assert not has_geometry(session.header.arm, model)
    figure = shape_bars_figure(model)
    assert len(figure.data) == len(model.modes)
    for bar, mode in zip(figure.data, model.modes, strict=True):
        assert np.max(np.abs(bar.y)) <= 1.0 + 1e-12
        assert np.allclose(bar.error_y.array, mode.shape_std.real, rtol=1e-9)
