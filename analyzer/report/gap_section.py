"""The gap result as a part of the report, and as a page of its own."""

from __future__ import annotations

from armodal.analyzer.gap.records import GapResult, Verdict
from armodal.analyzer.report.gap_figures import (
    gap_figure,
    gap_map_figures,
    stiffness_range_figure,
)
from armodal.analyzer.report.page_text import shown, templates
from armodal.analyzer.report.policy import under_policy

__all__ = ["gap_page", "gap_section"]

_WORDS = {
    Verdict.NAMED: "Named.",
    Verdict.AMBIGUOUS: "Ambiguous.",
    Verdict.NOTHING_DETECTABLE: "Nothing detectable.",
    Verdict.OUTSIDE_LIBRARY: "Outside the library.",
}
_ADVICE = {
    Verdict.NAMED: "see the rivals below",
    Verdict.AMBIGUOUS: "make the test that tells the standing rivals below apart",
    Verdict.NOTHING_DETECTABLE: "nothing; what could still hide is listed below",
    Verdict.OUTSIDE_LIBRARY: "look at the place the map of disagreement shows",
}
_STYLE = """body { font: 15px/1.45 system-ui, sans-serif; max-width: 1100px; margin: 2em auto;
padding: 0 1em; color: #222 } table { border-collapse: collapse; margin: 1em 0 }
th, td { padding: .25em .7em; text-align: left; border-bottom: 1px solid #ddd; vertical-align: top }
th { background: #f3f5f7 } caption { text-align: left; font-weight: 600 }
.verdict { background: #fff3d0; padding: .6em 1em; font-size: 1.15em }
.verdict.named, .verdict.nothing_detectable { background: #e3f3e6 }
.small { color: #666; font-size: .9em }
@media print { tr, .js-plotly-plot { break-inside: avoid } }"""


def gap_section(result: GapResult, *, with_plotly: bool) -> str:
    """Return the section as HTML; `with_plotly` puts the library of the plots into it."""
    environment = templates()
    after = {gap.posture: gap for gap in result.gap_after}
    figures = [f for f in (gap_figure(result), stiffness_range_figure(result)) if f is not None]
    figures += gap_map_figures(result)
    return environment.get_template("gap.html").render(
        r=result,
        verdict_words=_WORDS[result.verdict],
        advice=_ADVICE[result.verdict],
        told=_told,
        pairs=[(gap, after.get(gap.posture)) for gap in result.gap_before],
        figures=[
            f.to_html(
                full_html=False,
                include_plotlyjs=with_plotly and i == 0,
                config={"displayModeBar": False},
            )
            for i, f in enumerate(figures)
        ],
    )


def _told(value: object) -> str:
    """An entry of an effect's description in words."""
    if isinstance(value, (list, tuple)):
        return ", ".join(_told(part) for part in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def gap_page(result: GapResult, summary: str) -> str:
    """Return one self-contained HTML page; `summary` says in plain text which session it is of."""
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>armodal: gap</title>'
        f'<style>{_STYLE}</style></head><body><p class="small">{shown(summary)}</p>'
        f"{gap_section(result, with_plotly=True)}</body></html>"
    )
