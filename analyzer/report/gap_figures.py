"""Figures of a gap result."""

from __future__ import annotations

from typing import Any

import plotly.graph_objects as go

from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.report.page_text import shown

__all__ = ["gap_figure", "gap_map_figures", "stiffness_range_figure"]


def gap_figure(result: GapResult) -> Any:
    """FRF error of each posture before and after; None where nothing was compared."""
    if not result.gap_before:
        return None
    figure = go.Figure()
    for name, gaps in (("before", result.gap_before), ("after", result.gap_after)):
        figure.add_bar(
            x=[shown(g.posture) for g in gaps],
            y=[100 * g.frf_error for g in gaps],
            name=name,
        )
    figure.update_layout(height=320, title="FRF error by posture, %", margin={"t": 50})
    return figure


def stiffness_range_figure(result: GapResult) -> Any:
    """Joint stiffness with the range over all that may still be so; None without joints."""
    rows = result.joint_stiffness_ranges
    if not rows:
        return None
    k = [row.k_n_m_per_rad for row in rows]
    figure = go.Figure()
    figure.add_scatter(
        x=k,
        y=[shown(row.joint) for row in rows],
        mode="markers",
        marker={"size": 11},
        error_x={
            "type": "data",
            "symmetric": False,
            "array": [row.high - x for row, x in zip(rows, k, strict=True)],
            "arrayminus": [x - row.low for row, x in zip(rows, k, strict=True)],
        },
    )
    figure.update_layout(
        height=140 + 40 * len(rows), title="Joint stiffness, N m/rad", margin={"t": 50, "b": 40}
    )
    return figure


def gap_map_figures(result: GapResult) -> list[Any]:
    """Where model and measurement disagree, by posture, point and axis: one map a band."""
    figures = []
    for band in sorted({cell.band_hz for cell in result.where}):
        cells = [cell for cell in result.where if cell.band_hz == band]
        figure = go.Figure(
            go.Heatmap(
                x=[shown(f"{cell.point} {cell.axis}") for cell in cells],
                y=[shown(cell.posture) for cell in cells],
                z=[cell.ratio for cell in cells],
                colorscale="Viridis",
            )
        )
        figure.update_xaxes(type="category")
        figure.update_yaxes(type="category")
        title = f"Disagreement, {band[0]:.4g} to {band[1]:.4g} Hz (1: scatter explains it)"
        figure.update_layout(height=340, title=title)
        figures.append(figure)
    return figures
