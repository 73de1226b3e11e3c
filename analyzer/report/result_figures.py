"""Figures of modes, identification, prediction and plan."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from armodal.analyzer.identification.predicted_posture import Prediction
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.identification.scatter import stated_half_width_95
from armodal.analyzer.modal import ModalModel, synthesise
from armodal.analyzer.planning.selective import SelectivePlan
from armodal.analyzer.report.figures import UNITS
from armodal.analyzer.report.page_text import shown
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["joints_figure", "modes_figure", "plan_figure", "prediction_figure"]

LINES = 2000  # of a synthesis without the measured lines beside it


def modes_figure(model: ModalModel, frf: FrequencyResponse | None = None) -> Any:
    """RMS over all FRFs, measured and synthesised, above the poles over model orders.

    Parameters
    ----------
    model
        The fitted modes.
    frf
        What they were fitted to; without it the synthesis stands alone.
    """
    figure = make_subplots(specs=[[{"secondary_y": True}]])
    low, high = model.band_hz
    if frf is None:
        freq, decay = np.linspace(low, high, LINES), 0.0
    else:
        lines = (frf.freq_hz >= low) & (frf.freq_hz <= high)
        freq, decay = frf.freq_hz[lines], frf.decay_rad_s
        figure.add_scatter(x=freq, y=_rms(frf.values[..., lines]), name="measured")
    synthesis = synthesise(model, freq, decay_rad_s=decay)
    figure.add_scatter(x=freq, y=_rms(synthesis), name="model", line={"dash": "dash"})
    table = model.stabilisation
    figure.add_scatter(
        x=np.abs(table.pole_rad_s) / (2.0 * np.pi),
        y=table.order,
        mode="markers",
        marker={"size": 3, "color": "#999"},
        name="poles",
        secondary_y=True,
    )
    for mode in model.modes:
        figure.add_vline(x=mode.f_hz, line={"width": 1, "color": "#c00"})
    figure.update_yaxes(type="log", title=f"RMS of all FRFs, {UNITS[model.form]}")
    figure.update_yaxes(type="linear", title="model order", secondary_y=True)
    figure.update_xaxes(title="Hz", range=[low, high])
    return figure.update_layout(title=shown(f"{model.posture}: modes"), height=480)


def joints_figure(result: Identification) -> Any:
    """Joint stiffness with the 95 % interval of scatter and model together."""
    joints = result.joints
    half = [stated_half_width_95(joint) for joint in joints]
    figure = go.Figure()
    figure.add_scatter(
        x=[joint.k_n_m_per_rad for joint in joints],
        y=[shown(joint.joint) for joint in joints],
        mode="markers",
        marker={"size": 11},
        error_x={"type": "data", "array": half},
    )
    figure.update_xaxes(type="log", title="N m/rad")
    return figure.update_layout(title="Joint stiffness, 95 %", height=160 + 40 * len(joints))


def prediction_figure(prediction: Prediction) -> Any:
    """Which springs each predicted mode strains, with its frequency."""
    found = prediction.predicted
    posture = " ".join(f"{angle:g}" for angle in prediction.posture_deg)
    figure = go.Figure(
        go.Heatmap(
            x=[
                f"{f:.2f} ± {np.hypot(a, b):.2f} Hz"
                for f, a, b in zip(
                    found.modes.f_hz,
                    found.f_std_hz,
                    prediction.from_tolerances.f_std_hz,
                    strict=True,
                )
            ],
            y=[shown(name) for name in prediction.freedoms],
            z=100.0 * found.strain_share,
            zmin=0.0,
            zmax=100.0,
            colorscale="Blues",
            colorbar={"title": "% of strain energy"},
        )
    )
    figure.update_xaxes(type="category")
    return figure.update_layout(title=f"Predicted at {posture} deg")


def plan_figure(plan: SelectivePlan) -> Any:
    """How strongly each test's target joint is coupled to every elastic joint."""
    names = [joint.name for joint in plan.arm.joints]
    figure = go.Figure(
        go.Heatmap(
            x=[shown(names[joint]) for joint in plan.elastic.joints],
            y=[
                shown(f"test {number}: {names[test.target]}")
                for number, test in enumerate(plan.tests, start=1)
            ],
            z=[test.coupling for test in plan.tests],
            zmin=0.0,
            zmax=1.0,
            colorscale="Blues",
            colorbar={"title": "|M_ij| / M_ii"},
        )
    )
    figure.update_yaxes(autorange="reversed")
    return figure.update_layout(title="Coupling of each test's joint to the others")


def _rms(values: Any) -> Any:
    return np.sqrt(np.mean(np.abs(values) ** 2, axis=(0, 1)))
