"""A case's time beside the pace of the core that took it."""

import pytest

import armodal.study.pace
from armodal.study.pace import REFERENCE_S, pace
from armodal.study.page import study_page
from armodal.study.summary import study_summary
from armodal.study.tables import study_tables

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
    "place_right": None,
    "stands_out": None,
    "misfit": 0.3,
}


def test_a_core_that_takes_twice_as_long_has_a_pace_of_two(monkeypatch):
    readings = iter((0.0, 3 * 2.0 * REFERENCE_S))
    monkeypatch.setattr(armodal.study.pace, "process_time", lambda: next(readings))
    assert pace() == pytest.approx(2.0)


def test_times_are_told_at_the_reference_pace_too():
    lines = [
        {**LINE, "number": n, "cpu_s": cpu_s, "pace": of}
        for n, cpu_s, of in ((1, 10.0, 1.0), (2, 36.0, 2.0), (3, 24.0, 2.0))
    ]
    summary = study_summary(lines)
    assert summary["reference_s_median"] == 12.0
    assert summary["reference_s_most"] == 18.0
    assert "| 12 s, 18 s |" in study_page(study_tables(summary), "armodal gap-study")
