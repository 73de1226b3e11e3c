"""A study from drawing its cases to its tables."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from support.small_case import SmallCase

import armodal.study.cases
from armodal.hil_sim.study import draw_study
from armodal.study.run import run_study, seal_hashes
from armodal.study.summary import study_summary
from armodal.study.tables import study_tables


@pytest.mark.long
def test_a_small_study_is_sealed_judged_marked_and_goes_on_where_it_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr(armodal.study.cases, "sealed", SmallCase)
    specs = draw_study(
        77, nulls=1, effects=1, pairs=0, outside=0, arms=("ur5",), library=("channel_gain",)
    )
    # A clear effect is one that three postures tell too.
    specs = [replace(spec, magnitude="clear") if spec.kinds else spec for spec in specs]
    told = []
    with ThreadPoolExecutor(1) as executor:
        hashes = seal_hashes(specs, executor)
        lines = run_study(specs, hashes, tmp_path / "study.jsonl", executor, told.append)
        assert [x["outcome"] for x in lines] == ["right", "right"]
        assert len(told) == 2
        again = run_study(specs, hashes, tmp_path / "study.jsonl", executor, told.append)
    assert len(told) == 2  # nothing was judged twice
    assert again == lines
    summary = study_summary(lines)
    assert summary["groups"]["nulls"]["right"]["k"] == 1
    assert summary["confusion"] == {"channel_gain": {"channel_gain": 1}}
    assert summary["detection"][0]["size"] == 0.0
    assert all(table.rows for table in study_tables(summary))
    assert summary["k_covered"]["n"] > 0
