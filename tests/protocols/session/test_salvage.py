"""Salvage of journals that are torn, holed, interleaved, or of two sessions at once."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from support.damaged_journals import damaged, mixed, run_of

from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal import (
    MAGIC,
    Mark,
    MarkKind,
    decode_journal,
    encode_hit,
    encode_mark,
    load_journal,
    read_journal,
)
from armodal.protocols.session.journal_bytes import InMemory
from armodal.protocols.session.salvage import salvage
from armodal.protocols.session.salvage_files import rebuild_salvaged


def taken(found):
    return [bytes(b"".join(session.parts())) for session in found.sessions]


@pytest.fixture(scope="module")
def records(example, make_hit):
    first, *others = example.records
    hits = [encode_hit(make_hit(n, samples=200)) for n in range(4, 12)]
    return [first[len(MAGIC) :], *others, *hits]


def test_a_whole_journal_is_salvaged_as_it_is(example):
    found = salvage(InMemory(example.journal))
    assert taken(found) == [example.journal]
    assert (found.taken, found.dropped) == (len(example.records), ())


def seeds(quick, in_all):
    """So many seeds, of which the first are quick tests."""
    return [*range(quick), *(pytest.param(n, marks=pytest.mark.long) for n in range(quick, in_all))]


@pytest.mark.parametrize("seed", seeds(12, 150))
def test_every_whole_record_is_taken_in_its_order(records, seed):
    case = damaged(records, np.random.default_rng(seed))
    (journal,) = taken(salvage(InMemory(case.data)))
    assert journal == MAGIC + b"".join(case.whole)
    decode_journal(journal)


@pytest.mark.parametrize("seed", seeds(10, 30))
def test_without_its_header_a_journal_is_salvaged_by_anothers(header, records, seed):
    case = damaged(records, np.random.default_rng(seed), header_too=True)
    (journal,) = taken(salvage(InMemory(case.data), header=header))
    assert journal.endswith(b"".join(case.whole))
    assert len(decode_journal(journal).hits) == sum(r[4] == 2 for r in case.whole)


def test_without_any_header_it_says_what_is_there_and_wants_another(records):
    with pytest.raises(JournalError, match=r"no whole HEADER.*16 other whole records.*--header"):
        salvage(InMemory(MAGIC + b"".join(records[1:])))


@pytest.mark.parametrize("seed", seeds(6, 40))
def test_two_sessions_in_one_file_are_told_apart(header, make_hit, seed):
    """By the run of the board: a session that goes on after a stop starts it anew.

    Also in a slowed laboratory, and where the computer reads its clock late at times.
    """
    rng = np.random.default_rng(seed)
    header = replace(header, time_scale=(1.0, 0.125)[seed % 2])
    hits = [make_hit(n) for n in range(1, 15)]
    one = run_of(header, hits, session_id="aa", start_s=1000.0, late_s=0.3)
    other = run_of(header, hits[:9], session_id="bb", start_s=1007.0, late_s=0.3)
    both = mixed(one, other, rng)
    ours = salvage(InMemory(MAGIC + b"".join(both)))
    assert taken(ours) == [MAGIC + b"".join(one), MAGIC + b"".join(other)]
    case = damaged(both, rng)
    if case.whole[1] in one and other[0] in case.whole:  # else nothing tells which run is whose
        of_one, of_other = ([r for r in case.whole if r in part] for part in (one, other))
        assert taken(salvage(InMemory(case.data))) == [MAGIC + b"".join(of_one),
                                                       MAGIC + b"".join(of_other)]  # fmt: skip


def test_two_runs_that_gave_the_same_numbers_keep_all_their_hits(header, make_hit):
    """As two writers leave it that resumed one journal at once."""
    hits = [make_hit(n) for n in range(1, 6)]
    before = run_of(header, hits[:2], session_id="aa", start_s=0.0)
    one = run_of(header, hits[2:], session_id="aa", start_s=50.0)[1:]
    other = run_of(header, hits[2:], session_id="aa", start_s=60.0)[1:]
    rows = [record for pair in zip(one, other, strict=True) for record in pair]
    withdrawn = Mark(kind=MarkKind.WITHDRAWN, posture=None, point=None, host_s=1.0, hit=4)
    data = MAGIC + b"".join([*before, *rows, encode_mark(withdrawn)])
    with pytest.raises(JournalError, match=r"numbers have to rise.*--salvage"):
        decode_journal(data)
    found = salvage(InMemory(data))
    journal = decode_journal(taken(found)[0])
    assert [hit.number for hit in journal.hits] == [1, 2, 3, 4, 5, 6, 7, 8]
    assert np.array_equal(journal.hits[3].counts, hits[2].counts)
    assert [hit.number for hit in journal.hits if not hit.verdict.accepted] == [5, 6]
    at = len(MAGIC) + sum(map(len, [*before, *rows[:1]]))
    assert found.sessions[0].notes[0] == f"hit 3 at byte {at} is now hit 4"
    assert found.sessions[0].notes[-1] == "hit 4 was withdrawn: that is hit 5 and 6 now"


def test_a_record_that_says_the_impossible_is_dropped_by_name(example, make_hit):
    stranger = encode_hit(make_hit(4, posture_name="nowhere"))
    found = salvage(InMemory(example.journal + stranger + example.records[2]))
    assert taken(found) == [example.journal]
    assert len(found.dropped) == 2
    assert "no posture 'nowhere'" in found.dropped[0]
    assert "stands there twice" in found.dropped[1]


def test_files_are_written_beside_it_and_none_is_replaced(example, header, make_hit, tmp_path):
    path = tmp_path / "day.journal"
    at = len(example.records[0]) + 30
    path.write_bytes(example.journal[:at] + bytes(40) + example.journal[at + 40 :])
    for number in (1, 2):
        found, (file,) = rebuild_salvaged(path, software="test")
        assert file.journal == tmp_path / f"day.salvaged-{number}.journal"
        assert file.journal.stat().st_mode & 0o777 == 0o600
        assert len(load_journal(file.journal).hits) == 3
        assert file.session_file.is_file()
        assert len(found.dropped) == 1
    assert path.read_bytes()[at : at + 40] == bytes(40)
    path.write_bytes(MAGIC + encode_hit(make_hit(1)))
    _, (file,) = rebuild_salvaged(
        path, software="test", header_of=tmp_path / "day.salvaged-1.journal"
    )
    assert [hit.number for hit in read_journal(file.journal).hits] == [1]


def within_bounds():
    """A process may take 1 GiB and ten seconds of a processor."""
    resource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))
    resource.setrlimit(resource.RLIMIT_CPU, (10, 10))


@pytest.mark.long
def test_a_hole_costs_neither_memory_nor_long(example, tmp_path):
    """A sparse file of 2 GiB: three hits, a hole, one record."""
    path = tmp_path / "holed.journal"
    with path.open("wb") as file:
        file.write(b"".join(example.records[:-2]))
        file.seek(2**31 - len(example.records[-1]))
        file.write(example.records[-1])
    code = (
        "import sys; from pathlib import Path\n"
        "from armodal.protocols.session.journal import read_journal\n"
        "from armodal.protocols.session.journal_bytes import journal_file\n"
        "from armodal.protocols.session.salvage import salvage\n"
        "print(read_journal(sys.argv[1]).may_append)\n"
        "with journal_file(Path(sys.argv[1])) as data: print(salvage(data).taken)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)],
        capture_output=True, text=True, check=True, preexec_fn=within_bounds,
    )  # fmt: skip
    assert done.stdout.split() == ["False", str(len(example.records) - 1)]


def test_false_heads_end_the_search_and_that_is_said(example):
    head = (50_000_000).to_bytes(4, "little") + b"\x02\x00RJ"
    data = example.journal + b"x" + head * 200_000 + bytes(50_000_000)
    begun = time.process_time()
    found = salvage(InMemory(data))
    assert time.process_time() - begun < 10  # bound of a decoder at 100 MB
    assert taken(found) == [example.journal]
    assert "too many false heads" in found.dropped[-1]
