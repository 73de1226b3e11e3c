"""Lines are on the disk once they are judged, also those of a study that ends early."""

import json
from concurrent.futures import Executor, Future, ThreadPoolExecutor

import pytest

import armodal.study.curves
from armodal.hil_sim.study import CaseSpec
from armodal.study.curves import run_curves
from armodal.study.kept_lines import kept_lines, run_and_keep
from armodal.study.run import run_study

KEYS = ("number", "truth_sha256")
ONE, TWO = ({"number": n, "truth_sha256": str(n)} for n in (1, 2))
SPECS = [CaseSpec(number=n, arm="ur5", seed=n, kinds=(), magnitude="none") for n in (1, 2, 3, 4)]


def text_of(*lines):
    return "".join(json.dumps(line) + "\n" for line in lines)


def test_a_last_line_whole_but_for_its_end_is_kept(tmp_path):
    path = tmp_path / "study.jsonl"
    path.write_text(text_of(ONE, TWO)[:-1])
    told = []
    assert kept_lines(path, *KEYS, tell=told.append) == [ONE, TWO]
    assert path.read_text() == text_of(ONE, TWO)
    assert told == []


def test_a_file_torn_at_its_first_line_or_empty_begins_anew(tmp_path):
    path = tmp_path / "study.jsonl"
    for text in ("", "\n", '{"num'):
        path.write_text(text)
        assert kept_lines(path, *KEYS) == []
        assert path.read_text() == ""


class Failing(Executor):
    """The second job fails, the third waits; the first and the fourth are done meanwhile."""

    def __init__(self):
        self.futures = []

    def submit(self, fn, /, spec, *rest):
        future = Future()
        self.futures.append(future)
        number = len(self.futures)
        if number == 2:
            future.set_exception(MemoryError("no room"))
        elif number != 3:
            line = {"number": number, "truth_sha256": "", "varied": "hits", "n": 1}
            future.set_result(line | {"outcome": "right"})
        return future


@pytest.mark.parametrize("kind", ["study", "curves"])
def test_where_a_worker_fails_what_waits_is_cancelled_and_what_is_done_is_kept(
    tmp_path, monkeypatch, kind
):
    monkeypatch.setattr(armodal.study.curves, "VARIED", {"hits": (1,)})
    run = run_study if kind == "study" else run_curves
    executor, path = Failing(), tmp_path / "lines.jsonl"
    with pytest.raises(MemoryError, match="no room"):
        run(SPECS, {}, path, executor)
    assert executor.futures[2].cancelled()
    assert {line["number"] for line in kept_lines(path, "number")} == {1, 4}


def test_a_line_is_told_as_it_reads_in_the_file_and_after_it_is_there(tmp_path):
    path = tmp_path / "lines.jsonl"
    seen = []

    def tell(line):
        seen.append((line, path.read_text()))

    with ThreadPoolExecutor(1) as executor:
        run_and_keep(path, executor, lambda n: {"n": (n, n)}, [(1,)], tell)
    assert seen == [({"n": [1, 1]}, '{"n": [1, 1]}\n')]
