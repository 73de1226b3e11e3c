"""Kill a session at every change of its files, and cut the power there.

A session in the simulated laboratory is recorded through the file layer: interrupted in a write,
resumed, closed, its session file derived twice. For every create, write, sync, cut, renaming and
removal the disk is then laid out as a kill there leaves it (everything done, and part of a write)
and as a power cut may leave it (`tests/support/recorded_disk.py`), recovered, and resumed.

    python bench/torture_file_layer.py [seed]
"""

from __future__ import annotations

import multiprocessing
import sys
import tempfile
import threading
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from accepted_hits import wrong_after_stop
from figures import Figure, told
from recorded_disk import RecordingDisk, kill_points, power_cuts
from simulated_session import PLAN, Announcing, operate

from daq.acquisition import run_acquisition
from daq.settings import AcquisitionSettings
from hil_sim.lab import start_laboratory
from protocols.arm.files import load_arm
from protocols.plan import plan_from_text
from protocols.session.recovery import rebuild
from tui.acquire import ScriptedOperator

TIME_SCALE = 16.0
POINTS = ["2", "5", "8", "11"]
HITS = 8
CUTS = 40  # places within a write at most
REPLAYS = 5200
HALF = 5000  # bytes of the record that the interrupted session was writing


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
            thread = threading.Thread(
                target=run_acquisition, args=(settings, Announcing(theirs, disk.announce), disk)
            )
            thread.start()
            end = operate(ours, operator, stop_after=None if resume else HITS * len(POINTS) // 2)
            thread.join()
            print(f"recorded: {end}")
            if not resume:
                rebuild(journal, folder / "session.h5", software="torture", files=disk)
                # Stopped in a write: half of the last hit's record once more, as a torn tail.
                last = max((c for c in disk.log if c.kind == "write" and c.inode == 1), key=_size)
                with journal.open("ab") as file:
                    file.write(last.data[:HALF])
                disk.found(journal)
        operator.close()
    rebuild(journal, folder / "session.h5", software="torture", files=disk)
    return disk


def _size(change: object) -> int:
    return len(change.data)


def tried(points: Iterable, folder: Path, what: str) -> tuple[int, list[str]]:
    """Recover and resume from every disk; return how many there were, and what was wrong."""
    count, wrong, began = 0, [], time.monotonic()
    for where, files, announced in points:
        count += 1
        said = wrong_after_stop(files, announced, folder, "session.journal")
        if said is not None:
            wrong.append(f"{what} {where}: {said}")
            print(wrong[-1], flush=True)
        if count % 500 == 0:
            print(f"{what}: {count} in {time.monotonic() - began:.0f} s", flush=True)
    return count, wrong


def main() -> int:
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as home:
        session, disks = Path(home, "session"), Path(home, "disks")
        session.mkdir()
        disks.mkdir()
        disk = recorded(seed, session)
        n_hits = len({hit.number for change in disk.log for hit in change.hits})
        kinds = [change.kind for change in disk.log]
        print(", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds))))
        n_unsynced = sum(1 for _ in power_cuts(disk.log, rng, each=1))
        each = -(-REPLAYS // n_unsynced)
        kills, wrong = tried(kill_points(disk.log, rng, cuts=CUTS), disks, "kill")
        cuts, torn = tried(power_cuts(disk.log, rng, each=each), disks, "power cut")
    n_wrong = len(wrong) + len(torn)
    return told(
        [
            Figure("accepted hits in the recorded session", str(n_hits), "30", n_hits >= 30),
            Figure("kill points in the file layer", str(kills), "2000", kills >= 2000),
            Figure("sector replays of power cuts", str(cuts), "5000", cuts >= 5000),
            Figure("disks with a lost or altered accepted hit", str(n_wrong), "0", n_wrong == 0),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
