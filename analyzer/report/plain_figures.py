"""Figures of a plain structure's report, as plotly figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from armodal.analyzer.modal import ModalModel, mac_matrix, stable_poles, synthesise
from armodal.analyzer.modal.plscf import Stabilisation
from armodal.analyzer.report.figures import UNITS
from armodal.analyzer.report.frf_choice import shown_lines
from armodal.analyzer.report.page_text import shown
from armodal.analyzer.report.plain_words import shape_of
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["auto_mac_figure", "drift_figure", "stabilisation_figure", "synthesis_figure"]

MOST_FRFS = 24  # to choose from; a page of some megabytes
MOST_WRITTEN = 12  # modes of an AutoMAC whose values are written into it
MEASURED, MODEL, MODE = "#1f5fa8", "#d1495b", "#999"
LEGEND = {"orientation": "h", "x": 0.0, "y": 1.0, "yanchor": "bottom"}
MODEBAR = {"orientation": "v"}  # beside the legend, which a narrow screen needs whole
MARGIN = {"l": 60, "r": 15, "t": 60, "b": 45}


def synthesis_figure(frf: FrequencyResponse, model: ModalModel) -> Any:
    """Measured and synthesised: RMS of all FRFs, and each FRF to choose, worst explained first."""
    band = (frf.freq_hz >= model.band_hz[0]) & (frf.freq_hz <= model.band_hz[1])
    freq, values = frf.freq_hz[band], frf.values[..., band]
    synthesis = synthesise(model, freq, decay_rad_s=frf.decay_rad_s)
    figure = make_subplots(
        rows=2, cols=1, shared_xaxes=True, row_heights=[0.7, 0.3], vertical_spacing=0.04
    )
    choices = ["all FRFs, RMS"]
    rms = [np.sqrt(np.mean(np.abs(x) ** 2, axis=(0, 1))) for x in (values, synthesis)]
    at = shown_lines(rms[0])
    for name, curve, style in zip(("measured", "model"), rms, _styles(), strict=True):
        figure.add_scatter(
            x=_short(freq[at]), y=_short(curve[at]), name=name, line=style, row=1, col=1
        )
    worst = np.argsort(-model.frf_error, axis=None)[:MOST_FRFS]
    for i, j in np.stack(np.unravel_index(worst, model.frf_error.shape), axis=1):
        one, other = frf.responses[i], frf.references[j]
        choices.append(
            _text(
                f"{one.point} {one.label} over {other.point} {other.label}, "
                f"{100.0 * model.frf_error[i, j]:.2g} %"
            )
        )
        at = shown_lines(np.abs(values[i, j]))
        for name, curve, style in zip(
            ("measured", "model"), (values[i, j, at], synthesis[i, j, at]), _styles(), strict=True
        ):
            common = {"x": _short(freq[at]), "line": style, "visible": False}
            figure.add_scatter(y=_short(np.abs(curve)), name=name, row=1, col=1, **common)
            figure.add_scatter(
                y=_short(np.degrees(np.angle(curve))), showlegend=False, row=2, col=1, **common
            )
    buttons = []
    for k, label in enumerate(choices):
        visible = [k == 0] * 2 + [k == c for c in range(1, len(choices)) for _ in range(4)]
        buttons.append(
            {"label": label, "method": "update", "args": [{"visible": visible}, _rows(k > 0)]}
        )
    for mode in model.modes:
        figure.add_vline(x=mode.f_hz, line={"width": 0.5, "color": MODE})
    figure.update_yaxes(type="log", title=UNITS[frf.form], row=1, col=1)
    figure.update_yaxes(title="phase, deg", range=[-190, 190], row=2, col=1)
    figure.update_xaxes(title="Hz; grey lines are modes", row=2, col=1)
    return figure.update_layout(
        height=580,
        margin={**MARGIN, "t": 95},
        modebar=MODEBAR,
        legend=LEGEND,
        # Above the legend: on a narrow screen they do not fit beside one another.
        updatemenus=[
            {"buttons": buttons, "x": 0.0, "xanchor": "left", "y": 1.09, "yanchor": "bottom"}
        ],
    ).update_layout({name.replace(".", "_"): value for name, value in _rows(False).items()})


def stabilisation_figure(
    frf: FrequencyResponse, model: ModalModel, tables: Sequence[Stabilisation]
) -> Any:
    """Poles over model orders above the RMS of all FRFs; lines are the modes kept."""
    band = (frf.freq_hz >= model.band_hz[0]) & (frf.freq_hz <= model.band_hz[1])
    rms = np.sqrt(np.mean(np.abs(frf.values[..., band]) ** 2, axis=(0, 1)))
    at = shown_lines(rms)
    figure = make_subplots(specs=[[{"secondary_y": True}]])
    figure.add_scatter(
        x=_short(frf.freq_hz[band][at]),
        y=_short(rms[at]),
        name="RMS of all FRFs",
        line={"width": 1, "color": "#bbb"},
    )
    names = ("pole", "stable pole")
    for stable, name, style in zip(
        (False, True),
        names,
        ({"size": 4, "color": "#bbb", "symbol": "x-thin-open"}, {"size": 5, "color": MEASURED}),
        strict=True,
    ):
        kept = [stable_poles(table) == stable for table in tables]
        figure.add_scatter(
            x=np.concatenate([t.f_hz[k] for t, k in zip(tables, kept, strict=True)]),
            y=np.concatenate([t.order[k] for t, k in zip(tables, kept, strict=True)]),
            mode="markers",
            marker=style,
            name=name,
            secondary_y=True,
        )
    for mode in model.modes:
        figure.add_vline(x=mode.f_hz, line={"width": 1, "color": MODEL})
    figure.update_yaxes(type="log", title=UNITS[frf.form], secondary_y=False)
    figure.update_yaxes(
        type="linear", title="model order", showgrid=False, dtick=10, secondary_y=True
    )
    figure.update_xaxes(title="Hz; red lines are the modes kept", range=list(model.band_hz))
    return figure.update_layout(
        height=460, legend=LEGEND, modebar=MODEBAR, margin={**MARGIN, "r": 55}
    )


def auto_mac_figure(model: ModalModel) -> Any:
    """MAC of every mode's shape with every other's."""
    shapes = np.stack([shape_of(model, mode) for mode in model.modes], axis=1)
    values = mac_matrix(shapes, shapes)
    # Numbered too: two modes may round to one label.
    names = [f"{m + 1}: {mode.f_hz:.5g}" for m, mode in enumerate(model.modes)]
    written = len(names) <= MOST_WRITTEN
    figure = go.Figure(
        go.Heatmap(
            x=names,
            y=names,
            z=values.round(3),
            zmin=0.0,
            zmax=1.0,
            colorscale="Blues",
            texttemplate="%{z:.2f}" if written else None,
            colorbar={"title": "MAC", "thickness": 12},
        )
    )
    figure.update_xaxes(type="category", title="mode: Hz")
    figure.update_yaxes(type="category", autorange="reversed")
    side = int(np.clip(120 + 34 * len(names), 320, 640))
    return figure.update_layout(
        height=side, modebar=MODEBAR, margin={**MARGIN, "t": 20, "l": 75, "b": 75}
    )


def drift_figure(model: ModalModel) -> Any:
    """Every mode that moves: its frequency at each mounting, in half-power bandwidths."""
    figure = go.Figure()
    for mode in model.modes:
        if mode.drift is None:
            continue
        found = mode.drift.f_hz
        bandwidth = 2.0 * mode.damping_ratio * mode.f_hz
        seen = np.isfinite(found.value_std)
        figure.add_scatter(
            x=[_text(name) for name in model.mountings],
            y=np.where(seen, (found.value - found.mean) / bandwidth, np.nan),
            error_y={"type": "data", "array": np.where(seen, found.value_std, 0.0) / bandwidth},
            mode="markers+lines",
            line={"width": 1},
            name=f"{mode.f_hz:.5g} Hz",
        )
    figure.update_xaxes(title="point, in the order of the files", type="category")
    figure.update_yaxes(title="shift, half-power bandwidths")
    return figure.update_layout(
        height=360, legend=LEGEND, modebar=MODEBAR, margin=MARGIN, showlegend=True
    )


def _rows(with_phase: bool) -> dict[str, Any]:
    """Layout with the phase below, which a mean over FRFs has not."""
    if with_phase:
        return {"yaxis.domain": [0.32, 1.0], "yaxis2.domain": [0.0, 0.28], "yaxis2.visible": True}
    return {"yaxis.domain": [0.03, 1.0], "yaxis2.domain": [0.0, 0.02], "yaxis2.visible": False}


def _styles() -> tuple[dict[str, Any], dict[str, Any]]:
    return {"width": 1.5, "color": MEASURED}, {"width": 1.5, "color": MODEL, "dash": "dash"}


def _short(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    return values.astype(np.float32)


def _text(label: str) -> str:
    """A label as plotly shows it: it takes tags such as <b> in a text for its own."""
    return shown(label)
