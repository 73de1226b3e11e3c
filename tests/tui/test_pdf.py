"""A page on paper, by the browser or without one."""

from __future__ import annotations

import sys

import pytest
from support.browser import CHROMIUM, pdf_pages

from armodal.protocols.errors import SessionError
from armodal.tui import pdf
from armodal.tui.pdf import check_prints, print_pdf

PAGE = """<!doctype html><html><head><style>@page { size: A4; margin: 14mm }
.screen { display: none } section { break-after: page }</style></head><body>
<section><h1>Findings</h1><svg viewBox="0 0 100 20"><path d="M0 0H100" stroke="black"/></svg>
</section><section>Modes</section></body></html>"""


@pytest.fixture
def page(tmp_path):
    path = tmp_path / "report.html"
    path.write_text(PAGE, encoding="utf-8")
    return path


@pytest.fixture
def _no_browser(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))


@pytest.fixture
def _setter():
    """WeasyPrint and the libraries of the system that it needs: loaded where they are used."""
    try:
        import weasyprint  # noqa: F401, PLC0415
    except (ImportError, OSError):
        pytest.skip("WeasyPrint or its libraries are not installed")


@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
def test_the_browser_prints_every_page(page, tmp_path):
    print_pdf(page, tmp_path / "report.pdf")
    assert pdf_pages((tmp_path / "report.pdf").read_bytes()) == 2


@pytest.mark.usefixtures("_setter", "_no_browser")
def test_without_a_browser_the_page_is_set_and_nothing_is_said(page, tmp_path, capfd):
    print_pdf(page, tmp_path / "report.pdf")
    made = (tmp_path / "report.pdf").read_bytes()
    assert made.startswith(b"%PDF")
    assert capfd.readouterr() == ("", "")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "report.pdf"]


@pytest.mark.usefixtures("_no_browser")
def test_with_neither_one_message_says_what_to_install(monkeypatch):
    monkeypatch.setattr(pdf, "find_spec", lambda name: None)
    with pytest.raises(SessionError, match=r"weasyprint \(the extra pdf\) .* install one"):
        check_prints()


@pytest.mark.usefixtures("_no_browser")
def test_a_setter_without_its_libraries_is_one_message_too(monkeypatch):
    def missing(name):
        raise OSError("cannot load library 'libpango-1.0-0'\nmore of it")

    monkeypatch.setitem(sys.modules, "weasyprint", None)
    monkeypatch.setattr(pdf, "find_spec", lambda name: object())
    monkeypatch.setattr(pdf, "import_module", missing)
    with pytest.raises(SessionError, match="does not find the library Pango") as caught:
        check_prints()
    assert "\n" not in str(caught.value)
