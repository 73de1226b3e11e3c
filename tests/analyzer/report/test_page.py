"""The report: one file that loads nothing, runs nothing from elsewhere, and hides nothing."""

from __future__ import annotations

import stat
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from armodal.analyzer.report import PlotlyHome, write_report
from armodal.analyzer.report.words import plus_minus
from armodal.protocols.errors import SessionError
from armodal.protocols.session.records import Loss

EVIL = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def path(session, identified, tmp_path_factory):
    """The report of a session."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(session, identified, path)
    return path


@pytest.fixture(scope="module")
def one_posture(identified):
    """What a report needs that is quick to write."""
    first = {"frfs": identified.frfs[:1], "modal_models": identified.modal_models[:1]}
    return replace(identified, **first)


@pytest.fixture(scope="module")
def html(path):
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def told_html(session, one_posture, tmp_path_factory):
    """That of one with losses and warnings."""
    loss = Loss(kind="can", count=7, first_sample=None, host_s=0.0, note="frames lost")
    told = replace(session, losses=(loss,), warnings=("the tail was torn", EVIL), complete=False)
    path = tmp_path_factory.mktemp("told") / "report.html"
    write_report(told, one_posture, path)
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("who", ["", "shift two"])
def test_the_first_page_says_who_measured_or_that_it_was_not_recorded(
    session, one_posture, tmp_path, who
):
    told = replace(session, header=replace(session.header, measured_by=who))
    write_report(told, one_posture, tmp_path / "report.html")
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"<dt>Measured by</dt><dd>{who or 'not recorded'}</dd>" in html


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))


def tags(html):
    parser = Tags()
    parser.feed(html)
    return parser.found


def test_nothing_is_loaded_from_elsewhere(html):
    for tag, attributes in tags(html):
        assert not (
            tag in {"script", "img", "iframe", "link"} and {"src", "href"} & set(attributes)
        )


def test_every_stiffness_stands_in_it_with_both_uncertainties(html, identified):
    for row in (*identified.joints, *identified.axes):
        for value in (row.k_n_m_per_rad, row.k_std, row.k_std_model):
            assert f"{value:.0f}" in html


def test_every_posture_has_its_figures(html, session):
    for posture in session.header.plan.postures:
        for figure in ("arm, points, mode shape", "FRFs", "sums by group, CMIF"):
            assert f"{posture.name}: {figure}" in html


def test_provenance_names_arm_plan_and_board(html, session):
    header = session.header
    for name in (header.session_id, header.arm.sha256, header.plan.sha256):
        assert name in html
    assert header.dictionary.board_id in html
    for channel in header.dictionary.channels:
        assert channel.serial_number in html


def test_losses_and_warnings_stand_above_the_numbers(told_html):
    numbers = told_html.index("Joint stiffness, N m/rad")
    for said in ("frames lost", "the tail was torn", "points lack their hits"):
        assert told_html.index(said) < numbers


def test_text_from_files_is_shown_and_never_run(told_html):
    assert EVIL not in told_html
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in told_html


def test_the_file_has_the_permissions_of_any_other(path):
    ordinary = path.with_name("ordinary")
    ordinary.touch()
    assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE(ordinary.stat().st_mode)


def test_a_failed_write_leaves_the_older_report(session, one_posture, tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    path.write_text("older")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(SessionError, match="no space is left"):
        write_report(session, one_posture, path)
    assert path.read_text() == "older"
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_the_first_page_answers_before_any_table(html, identified):
    first = html.partition('<nav aria-label="Contents">')[0]
    found = first.partition('<div class="findings">')[2].partition("</div>")[0]
    (axis,) = identified.axes
    k, std = plus_minus(axis.k_n_m_per_rad, float(np.hypot(axis.k_std, axis.k_std_model)))
    assert f"The {axis.link} is compliant about an axis of its own: stiffness {k} ± {std}" in found
    assert first.index('<div class="findings">') < first.index("<table")
    for part in (
        "What to do next",
        "Checks of the measurement",
        "Validation postures: predicted",
        "<svg",
    ):
        assert part in first


def test_lost_preview_samples_are_no_warning(session, one_posture, tmp_path):
    loss = Loss(kind="stream", count=42, first_sample=None, host_s=0.0, note="link full")
    path = tmp_path / "report.html"
    write_report(replace(session, losses=(loss,)), one_posture, path)
    html = path.read_text(encoding="utf-8")
    assert 'class="warn"' not in html.partition("<nav")[0]
    assert "42 samples of the preview" in html


def test_many_reports_share_one_library(session, one_posture, tmp_path):
    path = tmp_path / "a.html"
    write_report(session, one_posture, path, plotly=PlotlyHome.SHARED)
    (library,) = tmp_path.glob("plotly-*.min.js")
    assert f'data-beside="{library.name}"' in path.read_text(encoding="utf-8")
    assert path.stat().st_size < library.stat().st_size


def test_a_page_of_an_arm_stays_below_four_megabytes(path):
    assert path.stat().st_size < 4e6
