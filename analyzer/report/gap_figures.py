"""Figure of a gap result."""

from __future__ import annotations

from typing import Any

import plotly.graph_objects as go

from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.report.page_text import shown

__all__ = ["gap_figure"]


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
