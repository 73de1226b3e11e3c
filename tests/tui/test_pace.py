"""A case's time beside the pace of the core that took it."""

import pytest

import armodal.tui.pace
from armodal.tui.gap_study_page import study_page
from armodal.tui.gap_study_summary import study_summary, study_tables
from armodal.tui.pace import REFERENCE_S, pace

LINE = {
    "number": 1,
    "magnitude": "none",
    "true": [],
    "true_verdict": "nothing_detectable",
    "outcome": "right",
    "verdict": "nothing_detectable",
    "named": [],
    "standing": [],
    "sizes": [],
    "stiffness": [],
    "gap": [],
    "over_true_model": None,
    "stands_out": None,
    "misfit": 0.3,
}


def test_a_core_that_takes_twice_as_long_has_a_pace_of_two(monkeypatch):
    readings = iter((0.0, 3 * 2.0 * REFERENCE_S))
    monkeypatch.setattr(armodal.tui.pace, "process_time", lambda: next(readings))
    assert pace() == pytest.approx(2.0)


def test_times_are_told_at_the_reference_pace_too():
    lines = [
        {**LINE, "number": n, "cpu_s": cpu_s, "pace": of}
        for n, cpu_s, of in ((1, 10.0, 1.0), (2, 36.0, 2.0), (3, 24.0, 2.0))
    ]
    summary = study_summary(lines)
    assert summary["reference_s_median"] == 12.0
    assert summary["reference_s_most"] == 18.0
    assert "| 12 s, 18 s |" in study_page(summary, [], "armodal gap-study")
    assert study_tables(summary)


def test_a_study_without_paces_has_times_as_they_were():
    summary = study_summary([{**LINE, "cpu_s": 10.0}])
    assert "reference_s_most" not in summary
    assert "at the pace of" not in study_page(summary, [], "armodal gap-study")
