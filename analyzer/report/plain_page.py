"""The report of a structure without joints: what the modes are, how sure, and what is not told."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from armodal.analyzer.modal import (
    ModalModel,
    drift_told,
    hit_choices,
    mass_scaling,
    record_notes,
    typical_random_errors,
)
from armodal.analyzer.modal.poles_by_order import poles_by_order
from armodal.analyzer.report.facts import facts, loss_warnings
from armodal.analyzer.report.figures import indicator_figure
from armodal.analyzer.report.frf_svg import frf_svg
from armodal.analyzer.report.open_figures import OpenFigures, PlotlyHome
from armodal.analyzer.report.page_style import style
from armodal.analyzer.report.page_text import templates
from armodal.analyzer.report.plain_figures import (
    LEGEND,
    MARGIN,
    MODEBAR,
    auto_mac_figure,
    drift_figure,
    stabilisation_figure,
    synthesis_figure,
)
from armodal.analyzer.report.plain_next import plain_steps
from armodal.analyzer.report.plain_svg import bar_tiles, moving_tiles, poles_svg
from armodal.analyzer.report.plain_words import answer, open_questions, shape_of
from armodal.analyzer.report.policy import under_policy
from armodal.analyzer.report.shape_figures import (
    has_geometry,
    moving_shapes_figure,
    shape_bars_figure,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.foreign.manifest import NO_ARM
from armodal.protocols.foreign.session_texts import UNKNOWN_PLACES
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import replace_text

__all__ = ["write_plain_report"]


def write_plain_report(
    session: Session,
    frfs: Sequence[FrequencyResponse],
    models: Sequence[ModalModel],
    path: Path,
    *,
    band_hz: tuple[float, float] | None = None,
    plotly: PlotlyHome = PlotlyHome.EMBEDDED,
) -> None:
    """Write one self-contained HTML page; an older one is replaced only when it is complete.

    Parameters
    ----------
    session
        Where the FRFs come from; its arm has no joints.
    frfs, models
        FRFs of each posture, and the modes fitted to them.
    path
        HTML file.
    band_hz
        The band that was asked for.
    plotly
        Whether the library for figures that move lies in the page or in a file beside it.

    Raises
    ------
    SessionError
        If the file cannot be written.
    """
    figures = OpenFigures(plotly)
    given = {frf.posture for frf in session.frfs}
    html = (
        templates()
        .get_template("plain.html")
        .render(
            style=style(),
            session=session,
            structure="" if session.header.arm.name == NO_ARM else session.header.arm.name,
            facts=facts(session),
            warnings=(
                *session.warnings,
                *loss_warnings(session),
                *_record_notes(session, frfs, models, band_hz),
            ),
            parts=[
                _part(session, frf, model, figures, averaged_here=frf.posture not in given)
                for frf, model in zip(frfs, models, strict=True)
            ],
            closing=figures.closing(),
        )
    )
    page = under_policy(html, later=figures.later_scripts(), trusting=figures.trusts_its_script())
    figures.write_beside(path)
    replace_text(path, page)


def _record_notes(
    session: Session,
    frfs: Sequence[FrequencyResponse],
    models: Sequence[ModalModel],
    band_hz: tuple[float, float] | None,
) -> list[str]:
    """What a person should know of the records behind the FRFs."""
    return [
        note
        for frf, model in zip(frfs, models, strict=True)
        for note in record_notes(
            session,
            frf.posture,
            band_hz=band_hz,
            ends_earlier=model.band_hz[1] < frf.freq_hz[-1],
        )
    ]


def _part(
    session: Session,
    frf: FrequencyResponse,
    model: ModalModel,
    figures: OpenFigures,
    *,
    averaged_here: bool,
) -> dict[str, Any]:
    """Everything of one posture, as the template wants it."""
    told = {one.f_hz: one for one in drift_told(model)}
    tables = poles_by_order(frf, model)
    part: dict[str, Any] = {
        "frf": frf,
        "model": model,
        "answer": answer(frf, model),
        "open": open_questions(frf, model),
        "next": plain_steps(frf, model),
        "rows": _rows(model, told),
        "drift": list(told.values()),
        "choices": hit_choices(session, frf.posture) if averaged_here else (),
        "averaged_here": averaged_here,
        "hits": sorted(set(frf.n_hits.ravel().tolist())),
        "coherence": _median_coherence(frf),
        "random_errors": typical_random_errors(frf),
        "frf_svg": frf_svg(frf, model, model.band_hz[1]),
        "poles_svg": poles_svg(model, tables),
        "synthesis": figures.button(synthesis_figure(frf, model), "Choose an FRF, zoom"),
        "stabilisation": figures.button(
            stabilisation_figure(frf, model, tables), "Zoom into the stabilisation diagram"
        ),
        "indicators": figures.button(
            _indicators(session, frf, model), "Indicators: sums, CMIF, MIF"
        ),
        "tiles": [],
        "shapes": "",
        "moving": False,
        "mac": "",
        "drift_figure": figures.button(drift_figure(model), "See them move from point to point")
        if told
        else "",
    }
    if model.modes and len(shape_of(model, model.modes[0])) > 1:
        arm = session.header.arm
        part["moving"] = moving = has_geometry(arm, model)
        part["tiles"] = moving_tiles(arm, model) if moving else bar_tiles(model)
        part["shapes"] = figures.button(
            moving_shapes_figure(arm, model) if moving else shape_bars_figure(model),
            "See them move" if moving else "With names and standard deviations",
        )
        if len(model.modes) > 1:
            part["mac"] = figures.button(auto_mac_figure(model), "Likeness of the shapes (AutoMAC)")
    return part


def _indicators(session: Session, frf: FrequencyResponse, model: ModalModel) -> Any:
    groups = {
        name: points for name, points in session.header.arm.groups.items() if name != UNKNOWN_PLACES
    }
    figure = indicator_figure(frf, model, groups, model.band_hz[1])
    return figure.update_layout(title=None, legend=LEGEND, modebar=MODEBAR, margin=MARGIN)


def _rows(model: ModalModel, told: dict[float, Any]) -> list[dict[str, Any]]:
    try:
        scaled: Sequence[Any] = mass_scaling(model)
    except EstimateError:
        scaled = [None] * len(model.modes)
    return [
        {
            "mode": mode,
            "mass": None if one is None else one.modal_mass_kg,
            "mass_std": None if one is None else one.modal_mass_std_kg,
            "moves": told.get(mode.f_hz),
        }
        for mode, one in zip(model.modes, scaled, strict=True)
    ]


def _median_coherence(frf: FrequencyResponse) -> float | None:
    told = frf.coherence[np.isfinite(frf.coherence)]
    return float(np.median(told)) if told.size else None
