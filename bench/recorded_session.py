"""A session recorded change by change, and recovery from the disks that a stop may have left.

The session runs in the simulated laboratory. It is stopped by the operator, then as if killed
between a write and its sync and once more within a write; resumed; closed; and its session file is
derived twice.
"""

from __future__ import annotations

import dataclasses
import multiprocessing
import os
import sys
import threading
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.accepted_hits import quick_folder, wrong_after_stop
from support.recorded_disk import Point, RecordingDisk
from support.simulated_session import PLAN, Announcing, operate

from armodal.daq.acquisition import run_acquisition
from armodal.daq.settings import AcquisitionSettings
from armodal.hil_sim.lab import start_laboratory
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal import encode_hit, read_journal
from armodal.protocols.session.recovery import rebuild
from armodal.tui.operators import ScriptedOperator

TIME_SCALE = 16.0
POINTS = ["2", "5", "8", "11"]
HITS = 4
HALF = 5000  # bytes of the record in whose writing the session was killed
BATCH = 50


def recorded(seed: int, folder: Path) -> RecordingDisk:
    """Record a session that is interrupted in a write, resumed and closed, and its file."""
    arm = load_arm("rv4frl")
    plan = plan_from_text(
        PLAN.format(hits=HITS, samples=2048, points=str(POINTS).replace("'", '"')), arm
    )
    disk = RecordingDisk()
    journal = folder / "session.journal"
    with start_laboratory("rv4frl", seed=seed, time_scale=TIME_SCALE) as laboratory:
        operator = ScriptedOperator(laboratory.operator, arm, plan, time_scale=TIME_SCALE)
        for resume in (False, True):
            settings = AcquisitionSettings(
                board_port=laboratory.board,
                can_channel=laboratory.can,
                arm=arm,
                plan=plan,
                journal=journal,
                time_scale=TIME_SCALE,
                resume=resume,
            )
            ours, theirs = multiprocessing.Pipe()
            teller = Announcing(theirs, disk.announce, journal)
            thread = threading.Thread(
                target=run_acquisition, args=(settings, teller), kwargs={"files": disk}
            )
            thread.start()
            end = operate(ours, operator, stop_after=None if resume else HITS * len(POINTS) // 2)
            thread.join()
            print(f"recorded: {end}")
            if not resume:
                rebuild(journal, folder / "session.h5", software="torture", files=disk)
                _leave_unsynced(journal, disk)
        operator.close()
    rebuild(journal, folder / "session.h5", software="torture", files=disk)
    return disk


def _leave_unsynced(journal: Path, disk: RecordingDisk) -> None:
    """Append a hit that was never synced, and half of another, as a killed session may."""
    last = read_journal(journal).hits[-1]
    following = [
        encode_hit(dataclasses.replace(last, number=last.number + more)) for more in (1, 2)
    ]
    with journal.open("ab") as file:
        file.write(following[0] + following[1][:HALF])
    disk.found(journal)


def tried(points: Iterable[Point], what: str) -> tuple[int, list[str]]:
    """Recover and resume from every disk; return how many there were, and what was wrong."""
    count, wrong, began = 0, [], time.monotonic()
    workers = os.cpu_count() or 1
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        batches, waiting = _batches(points), []
        for batch in batches:
            waiting.append(pool.submit(_wrong_of, batch))
            if len(waiting) > 2 * workers:
                count, wrong = _more(waiting.pop(0).result(), count, wrong)
                if count % 500 == 0:
                    print(f"{what}: {count} in {time.monotonic() - began:.0f} s", flush=True)
        for result in waiting:
            count, wrong = _more(result.result(), count, wrong)
    print(f"{what}: {count} in {time.monotonic() - began:.0f} s", flush=True)
    return count, wrong


def _more(result: tuple[int, list[str]], count: int, wrong: list[str]) -> tuple[int, list[str]]:
    n, said = result
    for line in said:
        print(line, flush=True)
    return count + n, wrong + said


def _batches(points: Iterable[Point]) -> Iterable[list[Point]]:
    batch = []
    for point in points:
        batch.append(point)
        if len(batch) == BATCH:
            yield batch
            batch = []
    yield batch


def _wrong_of(batch: list[Point]) -> tuple[int, list[str]]:
    wrong = []
    with quick_folder() as home:
        for where, files, announced in batch:
            said = wrong_after_stop(files, announced, Path(home), "session.journal")
            if said is not None:
                wrong.append(f"{where}: {said}")
    return len(batch), wrong
