"""The page of an arm: the answer first, then tables, figures and where every number comes from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.records import GapResult, Gate
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.modal import ModalModel, drift_told, hit_choices, missing_mode_hints
from armodal.analyzer.report.arm_svg import shape_tiles
from armodal.analyzer.report.check_rows import state_of
from armodal.analyzer.report.facts import preview_samples_lost
from armodal.analyzer.report.figures import arm_figure, frf_figure, indicator_figure
from armodal.analyzer.report.first_page import first_page
from armodal.analyzer.report.frf_choice import noisy_frfs
from armodal.analyzer.report.frf_svg import frf_svg
from armodal.analyzer.report.gap_section import gap_section
from armodal.analyzer.report.open_figures import OpenFigures, PlotlyHome
from armodal.analyzer.report.page_style import style
from armodal.analyzer.report.page_text import templates
from armodal.analyzer.report.policy import under_policy
from armodal.analyzer.report.words import plus_minus, rounded
from armodal.protocols.frf_records import FrequencyResponse
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
    gates: Sequence[Gate] = (),
    plotly: PlotlyHome = PlotlyHome.EMBEDDED,
) -> None:
    """Write one self-contained HTML page; an older one is replaced only when it is complete.

    Parameters
    ----------
    gates
        Checks of the measurement; those of `gap` where it is given.
    plotly
        Whether the library for figures that move lies in the page or in a file beside it.

    Raises
    ------
    SessionError
        If a file cannot be written.
    """
    superset = Superset(session.header.arm)
    figures = OpenFigures(plotly)
    checks = tuple(gates) if gap is None else gap.gates
    html = (
        templates()
        .get_template("report.html")
        .render(
            style=style(),
            session=session,
            result=identification,
            first=first_page(session, identification, superset, gap, checks),
            gates=checks,
            state_of=state_of,
            plus_minus=plus_minus,
            rounded=rounded,
            measured=_measured(session, identification, superset, figures),
            gap="" if gap is None else gap_section(gap, checks=False, told=session.warnings),
            sections=[
                {
                    "title": section.title,
                    "notes": section.notes,
                    "figures": [figures.at_once(figure) for figure in section.figures],
                }
                for section in sections
            ],
            preview_lost=preview_samples_lost(session),
            closing=figures.closing(),
        )
    )
    page = under_policy(html, later=figures.later_scripts(), trusting=figures.trusts_its_script())
    figures.write_beside(path)
    replace_text(path, page)


def _measured(
    session: Session, result: Identification, superset: Superset, figures: OpenFigures
) -> list[dict[str, Any]]:
    """Everything of each posture, as the template wants it."""
    top_hz = TOP_OVER_HIGHEST_MODE * max((m.f_hz for m in result.modes), default=100.0)
    given = {frf.posture for frf in session.frfs}
    groups = dict(session.header.arm.groups)
    rows = []
    for frf, model in zip(result.frfs, result.modal_models, strict=True):
        has_angles = frf.joints_rad is not None
        rows.append(
            {
                "frf": frf,
                "model": model,
                "choices": () if frf.posture in given else hit_choices(session, frf.posture),
                "drift": drift_told(model),
                "hints": missing_mode_hints(frf, model),
                "frac": _lowest_frac(frf, model),
                "tiles": shape_tiles(superset, frf, model),
                "svg": frf_svg(frf, model, top_hz),
                "arm": figures.button(
                    arm_figure(superset, frf, model, result.axes), f"{frf.posture}: see it move"
                )
                if has_angles
                else "",
                "open_frf": figures.button(
                    frf_figure(frf, top_hz, model), f"{frf.posture}: zoom into the FRFs"
                ),
                "open_indicators": figures.button(
                    indicator_figure(frf, model, groups, top_hz),
                    f"{frf.posture}: sums by group, CMIF, MIF",
                ),
            }
        )
    return rows


def _lowest_frac(frf: FrequencyResponse, model: ModalModel) -> tuple[float, str] | None:
    """The lowest likeness of an FRF and its modes, and which FRF it is; noise left out."""
    within = (frf.freq_hz >= model.band_hz[0]) & (frf.freq_hz <= model.band_hz[1])
    frac = np.where(frf.measured & ~noisy_frfs(frf, within), model.frac, np.nan)
    if not np.isfinite(frac).any():
        return None
    i, j = np.unravel_index(int(np.nanargmin(frac)), frac.shape)
    one, other = frf.responses[i], frf.references[j]
    return float(frac[i, j]), f"{one.point} {one.label} over {other.point} {other.label}"
