"""Plots of a workspace study, as plotly figures."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from armodal.analyzer.workspace.coupling import CouplingSweep
from armodal.analyzer.workspace.maps import FrequencyMap
from armodal.analyzer.workspace.meridian import ELBOWS
from armodal.analyzer.workspace.study import WorkspaceStudy
from armodal.protocols.arm.records import Arm

__all__ = ["coupling_figure", "map_figure", "mass_figure", "mode_figure"]


def mass_figure(study: WorkspaceStudy) -> Any:
    """Mean and standard deviation of |M_ij| (file 002, Fig. 3), logarithmic."""
    figure = go.Figure()
    joints = study.elastic.joints
    for title, chosen in (
        ("direct", [(i, i) for i in joints]),
        ("coupling", [(i, j) for i in joints for j in joints if i < j]),
    ):
        figure.add_bar(
            x=[f"M{i + 1}{j + 1}" for i, j in chosen],
            y=[study.mass.mean[i, j] for i, j in chosen],
            error_y={"array": [study.mass.std[i, j] for i, j in chosen]},
            name=title,
        )
    figure.update_yaxes(type="log", title="mean ± standard deviation, kg m²")
    figure.update_layout(title=f"Mass matrix of {study.arm}, {study.n_postures:,} random postures")
    return figure


def mode_figure(study: WorkspaceStudy) -> Any:
    """Mean and standard deviation of frequencies and damping (file 002, Figs. 12 and 13)."""
    figure = make_subplots(rows=1, cols=2, subplot_titles=("frequency, Hz", "damping, %"))
    names = [f"mode {i + 1}" for i in range(len(study.f_hz.mean))]
    for column, (moments, scale) in enumerate(
        ((study.f_hz, 1.0), (study.damping_ratio, 100.0)), start=1
    ):
        figure.add_bar(
            x=names,
            y=scale * moments.mean,
            error_y={"array": scale * moments.std},
            showlegend=False,
            row=1,
            col=column,
        )
    moving = ", ".join(str(i + 1) for i in study.moving)
    figure.update_layout(
        title=f"Modes of {study.arm}, {study.n_postures:,} postures, joints {moving} at random"
    )
    return figure


def coupling_figure(arm: Arm, sweep: CouplingSweep, swept: int) -> Any:
    """M_ij over both direct terms against an angle (file 002, Fig. 5)."""
    i, j = sweep.pair
    figure = go.Figure()
    angle = np.rad2deg(sweep.angle_rad)
    for values, by in ((sweep.to_first, i), (sweep.to_second, j)):
        figure.add_scatter(x=angle, y=values, name=f"M{i + 1}{j + 1} / M{by + 1}{by + 1}")
    low, high = np.rad2deg(arm.joints[swept].range_rad)
    for limit in (low, high):
        figure.add_vline(x=limit, line={"dash": "dot", "width": 1})
    figure.update_xaxes(title=f"joint {swept + 1}, degrees (dotted: its range)")
    figure.update_yaxes(title="ratio")
    figure.update_layout(title=f"Coupling of joints {i + 1} and {j + 1} of {arm.name}")
    return figure


def map_figure(arm: Arm, found: FrequencyMap, mode: int) -> Any:
    """Contours of one frequency over the wrist's position (file 002, Figs. 14 to 16)."""
    figure = make_subplots(rows=1, cols=2, subplot_titles=[f"elbow {name}" for name in ELBOWS])
    values = found.f_hz[..., mode]
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    for column in range(len(ELBOWS)):
        figure.add_trace(
            go.Contour(
                x=found.horizontal_m.round(4),
                y=found.vertical_m.round(4),
                z=values[column].round(3),
                zmin=low,
                zmax=high,
                colorscale="Greys_r",
                colorbar={"title": "Hz"},
                showscale=column == 0,
                ncontours=15,
            ),
            row=1,
            col=column + 1,
        )
    figure.update_xaxes(title="wrist, horizontal m", constrain="domain")
    figure.update_yaxes(scaleanchor="x", constrain="domain", col=1)
    figure.update_yaxes(scaleanchor="x2", constrain="domain", col=2)
    figure.update_yaxes(title="wrist, vertical m", col=1)
    figure.update_layout(title=f"Frequency of mode {mode + 1} of {arm.name}", height=520)
    return figure
