"""The report: one self-contained HTML page of a session and what was identified from it."""

from analyzer.report.page import ReportSection, write_report

__all__ = ["ReportSection", "write_report"]
