"""A session stopped anywhere: what was told to be accepted is recovered, byte for byte.

`make torture` does the same at length; its figures are in `docs/reliability.md`.
"""

from __future__ import annotations

import dataclasses
import errno
import multiprocessing
import os
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from support.accepted_hits import missing, quick_folder, wrong_after_stop
from support.fake_session import SCALE, Hammer, settings_of, whole_session
from support.faulty_disk import FaultyDisk, wrong_with_faulty_disk
from support.recorded_disk import RecordingDisk, kill_points, power_cuts
from support.simulated_session import operate

from armodal.daq.acquisition import run_acquisition
from armodal.daq.events import Failed, Finished, HitJudged
from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.session.journal import encode_hit, load_journal, read_journal
from armodal.protocols.session.records import Hit
from armodal.protocols.session.recovery import rebuild

HITS = 4  # of the plan
NAME = "session.journal"


@pytest.fixture
def record(lab, fakes, tmp_path):
    """Run a session to its end on a recording disk, and derive its session file twice."""

    def run(disk):
        end, _ = whole_session(lab, fakes["record"](), files=disk, announced=disk.announce)
        assert isinstance(end, Finished), end
        for _ in range(2):
            rebuild(lab.journal, lab.journal.with_suffix(".h5"), software="test", files=disk)
        return disk.log

    return run


@pytest.fixture
def folder():
    with quick_folder() as folder:
        yield Path(folder)


def some(points, most, seen=None):
    """So many points, each as likely as any other; all of them at once may take gigabytes."""
    rng, kept = np.random.default_rng(5), []
    for number, point in enumerate(points):
        if seen is not None:
            seen.add(len(point[2]))
        if number < most:
            kept.append(point)
        elif (at := rng.integers(number + 1)) < most:
            kept[at] = point
    return kept


@pytest.mark.parametrize("most", [10, pytest.param(30, marks=pytest.mark.long)])
def test_a_kill_at_any_change_loses_no_accepted_hit(record, folder, most):
    seen = set()
    points = kill_points(record(RecordingDisk()), np.random.default_rng(1), places=6)
    for where, files, announced in some(points, most, seen):
        assert wrong_after_stop(files, announced, folder, NAME) is None, where
    assert seen == set(range(HITS + 1))


@pytest.mark.parametrize("most", [10, pytest.param(30, marks=pytest.mark.long)])
def test_a_power_cut_with_reordered_sectors_loses_no_accepted_hit(record, folder, most):
    points = power_cuts(record(RecordingDisk()), np.random.default_rng(2), each=6)
    for where, files, announced in some(points, most):
        assert wrong_after_stop(files, announced, folder, NAME) is None, where


def test_the_torture_notices_a_journal_that_is_not_synced(record, folder):
    class Hasty(RecordingDisk):
        def sync(self, fd):
            """Return before anything is durable."""

    log = record(Hasty())
    lost = [
        wrong_after_stop(files, announced, folder, NAME)
        for _, files, announced in list(power_cuts(log, np.random.default_rng(3), each=2))[-20:]
        if NAME in files
    ]
    assert any(lost)


@pytest.mark.parametrize("lasting", [False, pytest.param(True, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    "code",
    [
        errno.EIO,
        *(pytest.param(code, marks=pytest.mark.long) for code in (errno.ENOSPC, errno.EROFS)),
    ],
)
def test_a_disk_that_refuses_a_change_is_named_and_loses_nothing(
    record, folder, lab, code, lasting
):
    record(RecordingDisk())
    session = load_journal(lab.journal)
    session = dataclasses.replace(session, hits=session.hits[:1])
    rng = np.random.default_rng(4)
    # Every change of such a session: begun, a hit, its file derived twice.
    at = 0
    while True:
        disk = FaultyDisk(at, code, lasting=lasting)
        assert wrong_with_faulty_disk(session, disk, folder, rng) is None, at
        if not disk.refused:
            break
        at += 1 if code == errno.EIO and lasting else 5
    assert at >= 14  # four to begin, two a hit, and five and four for its files


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (errno.ENOSPC, "no space is left on the disk"),
        pytest.param(errno.EIO, "the disk does not answer", marks=pytest.mark.long),
        pytest.param(errno.EROFS, "the disk can only be read", marks=pytest.mark.long),
    ],
)
def test_acquisition_says_that_the_disk_refuses_and_goes_on_after_it(
    lab, fakes, tmp_path, code, words
):
    told: list[HitJudged] = []
    disk = FaultyDisk(sys.maxsize, code, lasting=True)

    def announced(*hits: Hit) -> None:
        disk.announce(*hits)
        disk.fail_from_now()

    end, exit_code = whole_session(
        lab, fakes["record"](), files=disk, announced=announced, heard=told.append
    )
    assert isinstance(end, Failed)
    assert exit_code == 2
    assert words in end.message
    assert "resume the session" in end.message
    judged = [e.hit for e in told if isinstance(e, HitJudged)]
    hits = {hit.number: hit for hit in judged if hit.verdict.accepted}
    assert len(hits) == 1
    session = load_journal(lab.journal)
    assert missing(hits, session) is None
    assert len(session.hits) == len(judged)  # what was not told is not there
    disk.healthy = True
    end, exit_code = whole_session(lab, fakes["record"](), files=disk, resume=True)
    assert isinstance(end, Finished), end
    assert end.accepted == HITS
    assert missing(hits, load_journal(lab.journal)) is None


def test_a_hit_whose_sync_was_refused_is_written_again_when_resumed(record, lab):
    record(RecordingDisk())
    size = lab.journal.stat().st_size
    session = load_journal(lab.journal)
    again = encode_hit(dataclasses.replace(session.hits[-1], number=9))
    with lab.journal.open("ab") as file:
        file.write(again)
    disk = RecordingDisk(there=(NAME,))
    writer, journal = JournalWriter.resume(lab.journal, files=disk)
    writer.close()
    assert journal.hits[-1].number == 9
    assert [(c.kind, c.size) for c in disk.log] == [("rewrite", size), ("sync", 0), ("folder", 0)]
    assert read_journal(lab.journal).hits[-1].number == 9


@pytest.fixture
def acquiring(lab, fakes):
    """Run an acquisition in a process of its own, up to its first accepted hit."""
    lab.board.scale = lab.controller.scale = SCALE
    settings = settings_of(lab)
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=run_acquisition, args=(settings, theirs))
    process.start()
    theirs.close()
    heard = operate(ours, Hammer(lab, fakes["record"]()), until_hit=True)
    assert isinstance(heard, HitJudged), heard
    yield process, ours, heard.hit
    lab.controller.silent = True
    ours.close()
    process.kill()
    process.join()


@pytest.mark.long
def test_a_killed_process_leaves_its_hits_and_a_lock_that_stops_nobody(acquiring, lab, fakes):
    process, _, hit = acquiring
    process.kill()
    process.join()
    assert process.exitcode == -signal.SIGKILL
    recovered = rebuild(lab.journal, lab.journal.with_suffix(".h5"), software="test")
    assert missing({hit.number: hit}, recovered.session) is None
    assert "the session was not closed" in " ".join(recovered.session.warnings)
    end, code = whole_session(lab, fakes["record"](), resume=True)
    assert (code, end.complete) == (0, True)


def test_an_interrupt_of_the_terminal_ends_the_session_in_good_order(acquiring, lab):
    process, ours, hit = acquiring
    os.kill(process.pid, signal.SIGINT)  # as Ctrl-C sends it, to both
    ours.close()
    process.join(20.0)
    assert process.exitcode == 0
    journal = read_journal(lab.journal)
    assert journal.end is not None
    assert "has gone" in journal.end.reason
    assert hit.number in {found.number for found in journal.hits}
