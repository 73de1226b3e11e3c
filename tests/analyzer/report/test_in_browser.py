"""The report in a browser: whole at any width, silent, asking for nothing, and on paper."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.browser import CHROMIUM, browser, pdf_pages
from support.plain_structure import plate_session
from support.shown_gap import named_result

from armodal.analyzer.modal import fit_modes
from armodal.analyzer.report import PlotlyHome, write_plain_report, write_report

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")

OUTSIDE = """[...document.querySelectorAll('body *')].filter(e => {
    const box = e.getBoundingClientRect();
    return box.width > 0 && !e.closest('.wide') && !e.closest('svg > *')
        && (box.right > innerWidth + 1 || box.left < -1);
}).map(e => e.outerHTML.slice(0, 80))"""
# WCAG 2.2, 1.4.3: relative luminance and contrast of text against what lies behind it.
FAINT_TEXT = """(() => {
    const light = c => { const v = c.map(x => { x /= 255;
        return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; });
        return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; };
    const parts = s => s.match(/[\\d.]+/g).map(Number);
    const behind = e => { for (; e; e = e.parentElement) {
        const c = parts(getComputedStyle(e).backgroundColor);
        if (c.length < 4 || c[3] > 0) return c; }
        return [255, 255, 255]; };
    return [...document.querySelectorAll('body *')].filter(e =>
        [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()) && e.getClientRects().length
    ).filter(e => { const style = getComputedStyle(e);
        const text = parts(e.namespaceURI.endsWith('svg') ? style.fill : style.color);
        const both = [light(text.slice(0, 3)), light(behind(e).slice(0, 3))];
        return (Math.max(...both) + 0.05) / (Math.min(...both) + 0.05) < 4.5;
    }).map(e => e.textContent.slice(0, 60)); })()"""


@pytest.fixture(scope="module")
def path(session, identified, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(session, identified, path, gap=named_result(session))
    return path


@pytest.fixture(scope="module")
def without_gap(session, identified, tmp_path_factory):
    path = tmp_path_factory.mktemp("without") / "report.html"
    write_report(session, identified, path)
    return path


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain")
    plate = plate_session(folder)
    models = [fit_modes(frf) for frf in plate.frfs]
    write_plain_report(plate, plate.frfs, models, folder / "report.html")
    return folder / "report.html"


EVERY_KIND = pytest.mark.parametrize(
    "of", ["path", pytest.param("without_gap", marks=pytest.mark.long), "plain"]
)


@pytest.fixture(scope="module")
def page():
    with browser() as page:
        yield page


@EVERY_KIND
@pytest.mark.parametrize("width", [1280, 390])
def test_nothing_sticks_out_and_all_text_is_readable(page, of, width, request):
    page.open(request.getfixturevalue(of), width)
    assert page.run(OUTSIDE) == []
    assert page.run("document.documentElement.scrollWidth") <= width
    assert page.run(FAINT_TEXT) == []


@EVERY_KIND
def test_every_finding_is_seen_without_scrolling(page, of, request):
    page.open(request.getfixturevalue(of), 1280, 900)
    bottoms = page.run(
        "[...document.querySelectorAll('.findings')].map(e => e.getBoundingClientRect().bottom)"
    )
    assert bottoms[0] < 900


@pytest.fixture(scope="module")
def shared(session, identified, tmp_path_factory):
    path = tmp_path_factory.mktemp("shared") / "report.html"
    first = {"frfs": identified.frfs[:1], "modal_models": identified.modal_models[:1]}
    write_report(session, replace(identified, **first), path, plotly=PlotlyHome.SHARED)
    return path


@pytest.mark.parametrize(
    ("of", "label"),
    [("path", "see it move"), pytest.param("shared", "zoom into", marks=pytest.mark.long)],
)
def test_a_figure_opens_without_a_word_of_complaint(page, of, label, request):
    path = request.getfixturevalue(of)
    page.problems.clear()
    page.asked.clear()
    page.open(path, 1280)
    drawn = page.run(
        f"""(async () => {{
            const button = [...document.querySelectorAll('[data-figure] > button')]
                .find(b => b.textContent.includes('{label}'));
            const place = button.parentElement;
            button.click();
            for (let turn = 0; turn < 600 && place.contains(button); turn++)
                await new Promise(done => setTimeout(done, 50));
            return place.querySelectorAll('.js-plotly-plot .main-svg').length; }})()"""
    )
    assert drawn
    assert page.problems == []
    assert all(url.startswith(("file:", "blob:", "data:")) for url in page.asked)


@EVERY_KIND
def test_it_prints_on_eight_pages_at_most_the_answer_on_the_first(page, of, request):
    page.open(request.getfixturevalue(of), 1280)
    pdf = page.pdf()
    assert 2 <= pdf_pages(pdf) <= 8
    # A4 within its margins, at 96 CSS pixels an inch.
    page.call("Emulation.setEmulatedMedia", media="print")
    page.call(
        "Emulation.setDeviceMetricsOverride",
        width=round((210 - 28) / 25.4 * 96),
        height=900,
        deviceScaleFactor=1,
        mobile=False,
    )
    paper_px = (297 - 28) / 25.4 * 96
    height = page.run("document.querySelector('.first').getBoundingClientRect().height")
    # A figure is kept whole where it may not be broken, and is no taller than the paper.
    cut = page.run(
        f"""[...document.querySelectorAll('figure')].filter(e =>
            getComputedStyle(e).breakInside !== 'avoid'
            || e.getBoundingClientRect().height > {paper_px}).length"""
    )
    page.call("Emulation.setEmulatedMedia", media="")
    assert height < paper_px
    assert cut == 0
