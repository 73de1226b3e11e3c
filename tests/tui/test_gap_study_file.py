"""The file of a study: gone on with after it was torn, refused where it is no study's."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest

import tui.gap_curves
import tui.gap_study
from hil_sim.study import CaseSpec
from protocols.errors import SessionError
from tui.gap_curves import run_curves
from tui.gap_study import kept_lines, run_study

KEYS = ("number", "truth_sha256")
ONE, TWO = ({"number": n, "truth_sha256": str(n)} for n in (1, 2))
SPECS = [CaseSpec(number=n, arm="ur5", seed=n, kinds=(), magnitude="none") for n in (1, 2)]


def text_of(*lines):
    return "".join(json.dumps(line) + "\n" for line in lines)


def judged(spec, tests):
    return {"number": spec.number, "truth_sha256": str(spec.number)}


@pytest.mark.parametrize(
    "torn", ['{"number": 2, "tru', "[1]", "[1]\n", "\x00\x00", '{"number": 2}']
)
def test_a_study_goes_on_from_a_torn_file(tmp_path, monkeypatch, capsys, torn):
    monkeypatch.setattr(tui.gap_study, "run_case", judged)
    path = tmp_path / "study.jsonl"
    path.write_text(text_of(ONE) + torn)
    told = []
    with ThreadPoolExecutor(1) as executor:
        lines = run_study(SPECS, {1: "1", 2: "2"}, path, executor, told.append)
    assert lines == [ONE, TWO]
    assert told == [TWO]
    assert path.read_text() == text_of(ONE, TWO)
    assert "line 2 is torn" in " ".join(capsys.readouterr().err.split())


def test_a_last_line_whole_but_for_its_end_is_kept(tmp_path, capsys):
    path = tmp_path / "study.jsonl"
    path.write_text(text_of(ONE, TWO)[:-1])
    assert kept_lines(path, *KEYS) == [ONE, TWO]
    assert path.read_text() == text_of(ONE, TWO)
    assert capsys.readouterr().err == ""


def test_a_file_torn_at_its_first_line_or_empty_begins_anew(tmp_path):
    path = tmp_path / "study.jsonl"
    for text in ("", "\n", '{"num'):
        path.write_text(text)
        assert kept_lines(path, *KEYS) == []
        assert path.read_text() == ""


@pytest.mark.parametrize("odd", ["[1]", '{"number": 2', '{"number": [2], "truth_sha256": "2"}'])
def test_another_line_that_cannot_be_read_is_refused_by_its_number(tmp_path, odd):
    path = tmp_path / "study.jsonl"
    text = text_of(ONE) + odd + "\n" + text_of(TWO)
    path.write_text(text)
    with ThreadPoolExecutor(1) as executor, pytest.raises(SessionError, match="line 2: wanted"):
        run_study(SPECS, {}, path, executor)
    assert path.read_text() == text


def test_curves_go_on_from_a_torn_file(tmp_path, monkeypatch):
    monkeypatch.setattr(tui.gap_curves, "VARIED", {"points": (3,)})
    path = tmp_path / "curves.jsonl"
    with ThreadPoolExecutor(1) as executor:
        lines = run_curves(SPECS[:1], path, executor)
        path.write_text(path.read_text()[:-9])
        assert run_curves(SPECS[:1], path, executor) == lines
        assert path.read_text() == text_of(*lines)
        path.write_text("[1]\n" + text_of(*lines))
        with pytest.raises(SessionError, match="line 1: wanted"):
            run_curves(SPECS[:1], path, executor)
