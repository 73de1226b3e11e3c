"""Stiffness of the tool as a page with pictures, and as lines of a CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go

from armodal.analyzer.acting.self_motion import FreeAngle
from armodal.analyzer.acting.stiffness import PlaneStiffness, ToolStiffness
from armodal.analyzer.report.policy import under_policy
from armodal.protocols.arm.records import Arm

__all__ = ["angle_figure", "path_figure", "plane_figure", "stiffness_csv", "stiffness_page"]

_N_PER_UM = 1e-6


def stiffness_csv(arm: Arm, found: ToolStiffness) -> str:
    """Return a head and a line for each posture."""
    head = [
        *(f"{joint.name}_deg" for joint in arm.joints),
        *(f"tool_{a}_m" for a in "xyz"),
        *(f"displacement_{a}_m" for a in "xyz"),
        "stiffness_along_n_per_m",
        "stiffness_softest_n_per_m",
        "mozzi_axis_distance_m",
        *(f"compliance_{a}{b}_m_per_n" for a in "xyz" for b in "xyz"),
    ]
    rows = np.column_stack(
        [
            np.rad2deg(found.joints_rad),
            found.tool_m,
            found.displacement_m,
            found.along_n_per_m,
            found.softest_n_per_m,
            found.axis_distance_m,
            found.compliance_m_per_n.reshape(len(found.tool_m), 9),
        ]
    )
    lines = [",".join(head), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    return "\n".join(lines) + "\n"


def path_figure(arm: Arm, found: ToolStiffness) -> Any:
    """Stiffness along the force, and of the softest direction, posture by posture."""
    figure = go.Figure()
    at = np.arange(1, len(found.along_n_per_m) + 1)
    figure.add_scatter(x=at, y=_N_PER_UM * found.along_n_per_m, name="along the force")
    figure.add_scatter(x=at, y=_N_PER_UM * found.softest_n_per_m, name="softest direction")
    figure.update_xaxes(title="posture of the path")
    figure.update_yaxes(title="N/µm", rangemode="tozero")
    figure.update_layout(title=f"Stiffness at the tool of {arm.name}")
    return figure


def angle_figure(arm: Arm, found: FreeAngle) -> Any:
    """Stiffness over the free angle: of one pose a curve, of a path colours, the best marked."""
    figure = go.Figure()
    angle = np.rad2deg(found.angle_rad).round(3)
    along, best = _N_PER_UM * found.along_n_per_m, np.rad2deg(found.best_angle_rad)
    if len(along) == 1:
        figure.add_scatter(x=angle, y=along[0], name="along the force")
        marks = (("given", [0.0], found.given), ("stiffest", best, found.best))
        for name, at, own in marks:
            figure.add_scatter(
                x=at,
                y=_N_PER_UM * own.along_n_per_m,
                name=name,
                mode="markers",
                marker={"size": 12},
            )
        figure.update_xaxes(title="way of all joints together, deg")
        figure.update_yaxes(title="N/µm", rangemode="tozero")
    else:
        at = np.arange(1, len(along) + 1)
        figure.add_heatmap(
            x=at, y=angle, z=along.T, colorscale="Viridis", colorbar={"title": "N/µm"}
        )
        line = {"color": "black", "width": 3}
        together = np.rad2deg(found.together_angle_rad)
        figure.add_scatter(x=at, y=together, name="together", mode="lines+markers", line=line)
        figure.add_scatter(
            x=at,
            y=best,
            name="each alone",
            mode="markers",
            marker={"color": "white", "size": 6, "line": {"color": "black", "width": 1}},
        )
        figure.add_scatter(x=at, y=0.0 * at, name="given", line={"color": "red", "dash": "dot"})
        figure.update_layout(legend={"orientation": "h", "x": 0.7, "y": 1.12})
        figure.update_xaxes(title="posture of the path")
        figure.update_yaxes(title="way of all joints together, deg")
    figure.update_layout(title=f"Stiffness at the tool of {arm.name} over its free angle")
    return figure


def plane_figure(arm: Arm, found: PlaneStiffness) -> Any:
    """Stiffness along the force over the wrist's places, on a logarithmic scale."""
    # Where the force passes through every axis nothing gives way: a few such places would take the
    # whole scale of colours.
    low, high = np.log10(_N_PER_UM * np.nanquantile(found.along_n_per_m, (0.01, 0.95)))
    figure = go.Figure(
        go.Contour(
            x=found.horizontal_m.round(4),
            y=found.vertical_m.round(4),
            z=np.log10(_N_PER_UM * found.along_n_per_m).round(5),
            zmin=low,
            zmax=high,
            colorscale="Viridis",
            colorbar={
                "title": "N/µm",
                "tickvals": np.linspace(low, high, 6).tolist(),
                "ticktext": [f"{value:.3g}" for value in np.logspace(low, high, 6)],
            },
            contours={"start": low, "end": high, "size": (high - low) / 12.0},
        )
    )
    figure.update_xaxes(title="wrist, horizontal m", constrain="domain")
    figure.update_yaxes(title="wrist, vertical m", scaleanchor="x", constrain="domain")
    figure.update_layout(title=f"Stiffness at the tool of {arm.name}, stiffer elbow", height=560)
    return figure


def stiffness_page(arm: Arm, figures: Sequence[Any], words: Sequence[str]) -> str:
    """Return a self-contained page."""
    body = "\n".join(
        figure.to_html(full_html=False, include_plotlyjs=number == 0)
        for number, figure in enumerate(figures)
    )
    said = "".join(f"<p>{escape(text)}</p>" for text in words)
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(arm.name)}: stiffness</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">{said}{body}'
        "</body></html>\n"
    )
