"""The report: one self-contained HTML page of a session and what was identified from it."""

from armodal.analyzer.report.gap_file import gap_path, gap_to_json, read_gap
from armodal.analyzer.report.gap_section import gap_page
from armodal.analyzer.report.open_figures import PlotlyHome
from armodal.analyzer.report.page import ReportSection, write_report
from armodal.analyzer.report.plain_page import write_plain_report

__all__ = [
    "PlotlyHome",
    "ReportSection",
    "gap_page",
    "gap_path",
    "gap_to_json",
    "read_gap",
    "write_plain_report",
    "write_report",
]
