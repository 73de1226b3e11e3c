"""The report of a structure without joints: what the modes are, how sure, and what is not told."""

from __future__ import annotations

from collections import Counter
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
from armodal.analyzer.report.figures import indicator_figure
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
from armodal.analyzer.report.plain_words import answer, open_questions, shape_of
from armodal.analyzer.report.policy import under_policy
from armodal.analyzer.report.shape_figures import (
    has_geometry,
    moving_shapes_figure,
    shape_bars_figure,
)
from armodal.protocols.errors import EstimateError
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

    Raises
    ------
    SessionError
        If the file cannot be written.
    """
    environment = templates()
    figures = _Figures()
    given = {frf.posture for frf in session.frfs}
    html = environment.get_template("plain.html").render(
        session=session,
        warnings=[*session.warnings, *_record_notes(session, frfs, models, band_hz)],
        parts=[
            _part(session, frf, model, figures, averaged_here=frf.posture not in given)
            for frf, model in zip(frfs, models, strict=True)
        ],
        n_accepted=len(session.accepted()),
        rejected=dict(
            Counter(
                reason
                for hit in session.hits
                if not hit.verdict.accepted
                for reason in hit.verdict.reasons
            )
        ),
    )
    replace_text(path, under_policy(html))


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


class _Figures:
    """Turns figures into HTML; the first brings the program that draws them."""

    def __init__(self) -> None:
        self._first = True

    def html(self, figure: Any) -> str:
        text: str = figure.to_html(
            full_html=False,
            include_plotlyjs=self._first,
            auto_play=False,
            config={"responsive": True, "displaylogo": False},
        )
        self._first = False
        return text


def _part(
    session: Session,
    frf: FrequencyResponse,
    model: ModalModel,
    figures: _Figures,
    *,
    averaged_here: bool,
) -> dict[str, Any]:
    """Everything of one posture, as the template wants it."""
    told = {one.f_hz: one for one in drift_told(model)}
    part: dict[str, Any] = {
        "frf": frf,
        "model": model,
        "answer": answer(frf, model),
        "open": open_questions(frf, model),
        "rows": _rows(model, told),
        "drift": list(told.values()),
        "choices": hit_choices(session, frf.posture) if averaged_here else (),
        "averaged_here": averaged_here,
        "hits": sorted(set(frf.n_hits.ravel().tolist())),
        "coherence": _median_coherence(frf),
        "random_errors": typical_random_errors(frf),
        "synthesis": figures.html(synthesis_figure(frf, model)),
        "stabilisation": figures.html(stabilisation_figure(frf, model, poles_by_order(frf, model))),
        "indicators": figures.html(_indicators(session, frf, model)),
        "shapes": "",
        "moving": False,
        "mac": "",
        "drift_figure": figures.html(drift_figure(model)) if told else "",
    }
    if model.modes and len(shape_of(model, model.modes[0])) > 1:
        part["moving"] = has_geometry(session.header.arm, model)
        part["shapes"] = figures.html(
            moving_shapes_figure(session.header.arm, model)
            if part["moving"]
            else shape_bars_figure(model)
        )
        if len(model.modes) > 1:
            part["mac"] = figures.html(auto_mac_figure(model))
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
