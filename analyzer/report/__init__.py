"""The report: one self-contained HTML page of a session and what was identified from it."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from armodal.analyzer.report.gap_file import gap_path, gap_to_json, read_gap
    from armodal.analyzer.report.gap_section import gap_page
    from armodal.analyzer.report.marked_effects import drawn_effects
    from armodal.analyzer.report.open_figures import PlotlyHome
    from armodal.analyzer.report.page import ReportSection, write_report
    from armodal.analyzer.report.plain_page import write_plain_report

__all__ = [
    "PlotlyHome",
    "ReportSection",
    "drawn_effects",
    "gap_page",
    "gap_path",
    "gap_to_json",
    "read_gap",
    "write_plain_report",
    "write_report",
]

# Where each name comes from: a screen that reads a result loads no page and no figures.
_HOME = {
    "PlotlyHome": "open_figures",
    "ReportSection": "page",
    "drawn_effects": "marked_effects",
    "gap_page": "gap_section",
    "gap_path": "gap_file",
    "gap_to_json": "gap_file",
    "read_gap": "gap_file",
    "write_plain_report": "plain_page",
    "write_report": "page",
}


def __getattr__(name: str) -> Any:
    """Load a public name when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'armodal.analyzer.report' has no attribute {name!r}")
    value = getattr(import_module(f"armodal.analyzer.report.{_HOME[name]}"), name)
    globals()[name] = value
    return value
