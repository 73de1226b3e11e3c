"""The file of a study: gone on with after it was torn, refused where it is no study's."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest

import armodal.study.curves
import armodal.study.run
from armodal.hil_sim.study import CaseSpec, sealed
from armodal.protocols.errors import SessionError
from armodal.study.curves import run_curves
from armodal.study.run import run_study

ONE, TWO = ({"number": n, "truth_sha256": str(n), "tests": 0, "outcome": "right"} for n in (1, 2))
SPECS = [CaseSpec(number=n, arm="ur5", seed=n, kinds=(), magnitude="none") for n in (1, 2)]


def text_of(*lines):
    return "".join(json.dumps(line) + "\n" for line in lines)


def judged(spec, tests):
    return (ONE, TWO)[spec.number - 1] if spec.number < 3 else {"number": spec.number}


@pytest.mark.parametrize(
    "torn", ['{"number": 2, "tru', "[1]", "[1]\n", "\x00\x00", '{"number": 2}']
)
def test_a_study_goes_on_from_a_torn_file(tmp_path, monkeypatch, torn):
    monkeypatch.setattr(armodal.study.run, "run_case", judged)
    path = tmp_path / "study.jsonl"
    path.write_text(text_of(ONE) + torn)
    told = []
    with ThreadPoolExecutor(1) as executor:
        lines = run_study(SPECS, {1: "1", 2: "2"}, path, executor, told.append)
    assert lines == [ONE, TWO]
    torn_told, judged_told = told
    assert "line 2 is torn" in torn_told
    assert judged_told == "case 2: right"
    assert path.read_text() == text_of(ONE, TWO)


@pytest.mark.parametrize("odd", ["[1]", '{"number": 2', '{"number": [2], "truth_sha256": "2"}'])
def test_another_line_that_cannot_be_read_is_refused_by_its_number(tmp_path, odd):
    path = tmp_path / "study.jsonl"
    text = text_of(ONE) + odd + "\n" + text_of(TWO)
    path.write_text(text)
    with ThreadPoolExecutor(1) as executor, pytest.raises(SessionError, match="line 2: wanted"):
        run_study(SPECS, {}, path, executor)
    assert path.read_text() == text


def test_curves_go_on_from_a_torn_file(tmp_path, monkeypatch):
    monkeypatch.setattr(armodal.study.curves, "VARIED", {"points": (3,)})
    path = tmp_path / "curves.jsonl"
    hashes = {1: sealed(SPECS[0]).truth_sha256}
    with ThreadPoolExecutor(1) as executor:
        lines = run_curves(SPECS[:1], hashes, path, executor)
        path.write_text(path.read_text()[:-9])
        assert run_curves(SPECS[:1], hashes, path, executor) == lines
        assert path.read_text() == text_of(*lines)
        path.write_text("[1]\n" + text_of(*lines))
        with pytest.raises(SessionError, match="line 1: wanted"):
            run_curves(SPECS[:1], hashes, path, executor)


HIDING = CaseSpec(number=3, arm="ur5", seed=3, kinds=("delay",), magnitude="clear")


@pytest.mark.parametrize(
    ("kept", "tests", "again"),
    [
        ({"tests": 2}, 2, False),
        ({"tests": 2}, 1, True),
        ({"tests": 0}, 2, True),
        ({"tests": 2}, 0, True),
        ({}, 0, True),
    ],
)
def test_a_line_judged_with_another_number_of_tests_does_not_count(
    tmp_path, monkeypatch, kept, tests, again
):
    monkeypatch.setattr(armodal.study.run, "run_case", judged)
    path = tmp_path / "study.jsonl"
    path.write_text(text_of({"number": 3, "truth_sha256": "3"} | kept))
    told = []
    with ThreadPoolExecutor(1) as executor:
        run_study([HIDING], {3: "3"}, path, executor, told.append, tests=tests)
    assert bool(told) is again


def test_a_null_that_may_not_ask_counts_whatever_the_number_of_tests(tmp_path, monkeypatch):
    monkeypatch.setattr(armodal.study.run, "run_case", judged)
    path = tmp_path / "study.jsonl"
    path.write_text(text_of(ONE, TWO))
    told = []
    with ThreadPoolExecutor(1) as executor:
        run_study(SPECS, {1: "1", 2: "2"}, path, executor, told.append, tests=2)
    assert told == []
