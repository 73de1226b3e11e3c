"""The gap result as a part of the report, and as a page of its own."""

from __future__ import annotations

from collections.abc import Collection

from armodal.analyzer.gap.records import GapResult, Verdict
from armodal.analyzer.report.effect_words import (
    certainty,
    chance,
    hidden_in_words,
    mechanics_of,
    weight,
)
from armodal.analyzer.report.gap_svg import disagreement_svgs, errors_svg
from armodal.analyzer.report.page_style import style
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
    Verdict.OUTSIDE_LIBRARY: "look at the point and axis named in the summary",
}


def gap_section(
    result: GapResult, *, checks: bool, arm: str = "", told: Collection[str] = ()
) -> str:
    """Return the section as HTML; `checks` lists those of the measurement in it.

    `arm` is a drawing with what was found marked, where it stands on no page before; notes that
    are among `told` stand there.
    """
    after = {gap.posture: gap for gap in result.gap_after}
    return (
        templates()
        .get_template("gap.html")
        .render(
            r=result,
            verdict_words=_WORDS[result.verdict],
            advice=_ADVICE[result.verdict],
            mechanics=mechanics_of,
            certainty=certainty,
            chance=chance,
            weight=weight,
            hidden=hidden_in_words,
            arm=arm,
            pairs=[(gap, after.get(gap.posture)) for gap in result.gap_before],
            errors=errors_svg(result),
            maps=disagreement_svgs(result),
            checks=checks,
            notes=[note for note in result.notes if note not in told],
        )
    )


def gap_page(result: GapResult, summary: str, arm: str = "") -> str:
    """Return one self-contained HTML page.

    Parameters
    ----------
    summary
        Says in plain text which session it is of.
    arm
        A drawing with what was found (`drawn_effects`); none where it is empty.
    """
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>armodal: gap</title><style>{style()}</style></head><body>"
        f'<p class="quiet">{shown(summary)}</p>'
        f"{gap_section(result, checks=True, arm=arm)}</body></html>"
    )
