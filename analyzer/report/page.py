"""The page itself: tables, figures and where every number comes from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.modal import drift_told, hit_choices, missing_mode_hints
from armodal.analyzer.report.figures import arm_figure, frf_figure, indicator_figure
from armodal.analyzer.report.gap_section import gap_section
from armodal.analyzer.report.page_text import templates
from armodal.analyzer.report.policy import under_policy
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import replace_text

__all__ = ["ReportSection", "write_report"]

TOP_OVER_HIGHEST_MODE = 1.5


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportSection:
    """Plots that stand in the report beside the session's own."""

    title: str
    notes: tuple[str, ...]
    figures: tuple[Any, ...]  # plotly


def write_report(
    session: Session,
    identification: Identification,
    path: Path,
    *,
    sections: Sequence[ReportSection] = (),
    gap: GapResult | None = None,
) -> None:
    """Write one self-contained HTML page; an older one is replaced only when it is complete.

    Raises
    ------
    SessionError
        If the file cannot be written.
    """
    environment = templates()
    html = environment.get_template("report.html").render(
        **_content(session, identification, sections),
        gap="" if gap is None else gap_section(gap, with_plotly=False),
    )
    replace_text(path, under_policy(html))


def _content(
    session: Session, identification: Identification, sections: Sequence[ReportSection]
) -> dict[str, Any]:
    superset = Superset(session.header.arm)
    highest = max((m.f_hz for m in identification.modes), default=100.0)
    top_hz = TOP_OVER_HIGHEST_MODE * highest
    figures: list[str] = []
    for frf, model in zip(identification.frfs, identification.modal_models, strict=True):
        for figure in (
            arm_figure(superset, frf, model, identification.axes),
            frf_figure(frf, top_hz),
            indicator_figure(frf, model, dict(session.header.arm.groups), top_hz),
        ):
            figures.append(
                figure.to_html(full_html=False, include_plotlyjs=not figures, auto_play=False)
            )
    rejected = Counter(
        reason for hit in session.hits for reason in hit.verdict.reasons if not hit.verdict.accepted
    )
    given = {frf.posture for frf in session.frfs}
    return {
        "session": session,
        "measured": [
            {
                "frf": frf,
                "model": model,
                "choices": () if frf.posture in given else hit_choices(session, frf.posture),
                "drift": drift_told(model),
                "hints": missing_mode_hints(frf, model),
            }
            for frf, model in zip(identification.frfs, identification.modal_models, strict=True)
        ],
        "result": identification,
        "figures": figures,
        "sections": [
            {
                "title": section.title,
                "notes": section.notes,
                "figures": [
                    figure.to_html(full_html=False, include_plotlyjs=not figures)
                    for figure in section.figures
                ],
            }
            for section in sections
        ],
        "n_accepted": len(session.accepted()),
        "n_rejected": len(session.hits) - len(session.accepted()),
        "rejected": dict(rejected),
    }
