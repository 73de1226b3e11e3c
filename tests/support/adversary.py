"""Sessions that somebody disturbs: their journal, its folder, its disk, the clock, the board.

After each, every hit that was told to be accepted must lie in the journal, in what was rescued of
it, or in its mirror, byte for byte.
"""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from support.accepted_hits import quick_folder
from support.fault_runs import PLAN, shipped_arm
from support.virtual_lab import STEP_S, VirtualLab

from armodal.daq.acquisition import run_acquisition
from armodal.daq.events import Failed, Finished, HitJudged
from armodal.daq.settings import AcquisitionSettings
from armodal.hil_sim.faults import Fault
from armodal.protocols.errors import ArmodalError
from armodal.protocols.file_layer import Disk
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal import decode_journal, load_journal
from armodal.protocols.session.journal_bytes import journal_file
from armodal.protocols.session.salvage import salvage

MOST_RUNS = 4
CHANGES = 22  # of the disk in an undisturbed session, about; with a mirror twice as many


def removed(path: Path) -> None:
    path.unlink()


def moved(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))


def replaced(path: Path) -> None:
    shutil.copy(path, path.with_name("copy"))
    path.with_name("copy").replace(path)


def replaced_by_a_link(path: Path) -> None:
    path.rename(path.with_name("target"))
    path.symlink_to(path.with_name("target"))


def cut(path: Path) -> None:
    os.truncate(path, path.stat().st_size * 2 // 3)


def emptied(path: Path) -> None:
    os.truncate(path, 0)


def holed(path: Path) -> None:
    os.truncate(path, path.stat().st_size + 100_000)


def written_to(path: Path) -> None:
    with path.open("ab") as file:
        file.write(path.read_bytes()[-500:])


def folder_removed(path: Path) -> None:
    shutil.rmtree(path.parent)


def folder_moved(path: Path) -> None:
    path.parent.rename(path.parent.with_name("moved"))
    path.parent.mkdir()


def lock_removed(path: Path) -> None:
    for lock in path.parent.glob(".*.lock"):
        lock.unlink()


def another_writer(path: Path) -> None:
    """A second session by another name of the journal, its lock's file gone."""
    lock_removed(path)
    other = path.with_name("other.journal")
    os.link(path, other)
    with other.open("r+b") as file:
        file.seek(0, os.SEEK_END)
        file.write(b"a second session")


ON_FILES = (
    removed, moved, replaced, replaced_by_a_link, cut, emptied, holed, written_to, folder_removed,
    folder_moved, lock_removed, another_writer,
)  # fmt: skip
ON_DISK = {
    "read-only from now on": (errno.EROFS, ("create", "write", "cut", "rewrite"), True),
    "permission withdrawn": (errno.EACCES, ("create", "open", "write", "cut"), True),
    "full": (errno.ENOSPC, ("create", "write"), True),
    "a late error, told once": (errno.EIO, ("sync",), False),
    "late errors, told at every sync": (errno.EIO, ("sync",), True),
    "stale handle": (errno.ESTALE, ("write", "sync", "cut", "close"), True),
}
IN_TIME = ("host stops for 30 s", "host is suspended for 60 s")
OF_LAB = (
    str(Fault.BOARD_REBOOT),
    "board-reboot at a blow",
    str(Fault.CLOCK_JUMP),
    "stale angles",
    "overload",
    "missing calibration",
)
KINDS = (*(f.__name__ for f in ON_FILES), *ON_DISK, *IN_TIME, *OF_LAB)


class AttackedDisk(Disk):
    """Does something at a certain change of the disk, and refuses changes from then on."""

    def __init__(self, at: int, attack: Callable[[], None]) -> None:
        self._left = at
        self._attack = attack
        self.refuses: tuple[int, tuple[str, ...], bool] | None = None
        self.struck = False

    def _change(self, kind: str) -> None:
        self._left -= 1
        if self._left == 0 and kind != "close":  # then the session is over
            self._attack()
        if self.refuses is not None and kind in self.refuses[1]:
            code, _, lasting = self.refuses
            self.struck = True
            if not lasting:
                self.refuses = None
            raise OSError(code, os.strerror(code))

    def create(self, path: Path) -> int:
        self._change("create")
        return super().create(path)

    def open(self, path: Path) -> int:
        self._change("open")
        return super().open(path)

    def write(self, fd: int, data: bytes | memoryview) -> int:
        self._change("write")
        return super().write(fd, data)

    def rewrite(self, path: Path, data: bytes, at: int) -> None:
        self._change("rewrite")
        super().rewrite(path, data, at)

    def sync(self, fd: int) -> None:
        self._change("sync")
        super().sync(fd)

    def cut(self, fd: int, size: int) -> None:
        self._change("cut")
        super().cut(fd, size)

    def close(self, fd: int) -> None:
        try:
            self._change("close")
        finally:
            super().close(fd)

    def sync_folder(self, path: Path) -> None:
        self._change("folder")
        super().sync_folder(path)


@dataclass
class Disturbed:
    """What became of one session."""

    kind: str
    announced: int
    lost: list[int]
    endings: list[str]
    wrong: str = ""
    struck: bool = False  # whether the disturbance came about before the session's end


def disturbed_session(seed: int, *, step_s: float = STEP_S) -> Disturbed:
    """Run a small session that is disturbed once, resumed where it ends; kinds go in turn."""
    rng = np.random.default_rng([seed, 0xAD])
    kind = KINDS[seed % len(KINDS)]
    arm = shipped_arm()
    plan = plan_from_text(PLAN, arm)
    with quick_folder() as folder:
        root = Path(folder)
        (root / "data").mkdir()
        (root / "mirror").mkdir()
        faults, at_blows = _script(kind, rng)
        calibrated = kind != "missing calibration"
        lab = VirtualLab(
            plan, root, seed=seed, faults=faults, at_blows=at_blows, calibrated=calibrated,
            step_s=step_s,
        )  # fmt: skip
        settings = AcquisitionSettings(
            board_port="board", can_channel="can", arm=arm, plan=plan,
            journal=root / "data" / "session.journal", session_id="a" * 16,
            mirror=root / "mirror" if rng.random() < 0.3 else None,
        )  # fmt: skip
        disk = AttackedDisk(
            int(rng.integers(2, CHANGES * (1 if settings.mirror is None else 2))),
            lambda: _disturb(kind, settings.journal, disk, lab),
        )
        found = Disturbed(kind=kind, announced=0, lost=[], endings=[])
        before = os.environ.get("XDG_RUNTIME_DIR")
        os.environ["XDG_RUNTIME_DIR"] = str(root)
        old = os.umask(0)
        try:
            hits = _sessions(lab, settings, disk, found)
        finally:
            os.umask(old)
            lab.close()
            if before is None:
                del os.environ["XDG_RUNTIME_DIR"]
            else:
                os.environ["XDG_RUNTIME_DIR"] = before
        found.announced = len(hits)
        found.struck = disk.struck if kind not in OF_LAB else _reached(lab, faults, at_blows)
        there = _recoverable(root)
        found.lost = [hit.number for hit in hits if hit.counts.tobytes() not in there]
        loose = [p.name for p in root.rglob("*") if p.is_file() and p.stat().st_mode & 0o077]
        if loose := [name for name in loose if name not in {"copy", "ledger.jsonl"}]:
            found.wrong = f"others may read {loose}"
    return found


def _script(kind: str, rng: np.random.Generator) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    if kind == "board-reboot at a blow":
        after = int(rng.integers(-64, 256))
        return (), ((int(rng.integers(1, 5)), str(Fault.BOARD_REBOOT), after, 0),)
    if kind == "stale angles":
        return (f"{Fault.CAN_SILENCE}@{int(rng.integers(0, 6000))}+2000",), ()
    if kind == "overload":
        blow, after = int(rng.integers(1, 5)), int(rng.integers(-64, 256))
        return (), ((blow, str(Fault.CHANNEL_CLIPPED), after, int(rng.integers(16, 4000))),)
    if kind == "missing calibration":
        return (), ()
    if kind in OF_LAB:
        return (f"{kind}@{int(rng.integers(0, 6000))}",), ()
    return (), ()


def _reached(lab: VirtualLab, faults: tuple[str, ...], at_blows: tuple[Any, ...]) -> bool:
    """Whether the laboratory came to the sample or blow that its fault was to come at."""
    sampled = max((epoch.next_sample for epoch in lab.epochs), default=0)
    starts = [int(fault.partition("@")[2].partition("+")[0]) for fault in faults]
    return all(at < sampled for at in starts) and all(at[0] <= lab.n_blows for at in at_blows)


def _disturb(kind: str, journal: Path, disk: AttackedDisk, lab: VirtualLab) -> None:
    if kind in ON_DISK:
        disk.refuses = ON_DISK[kind]
    elif kind == "host stops for 30 s":
        lab.advance(30.0)
        disk.struck = True
    elif kind == "host is suspended for 60 s":
        lab.advance(60.0)
        lab.behind_s += 60.0
        disk.struck = True
    else:
        for attack in ON_FILES:
            if attack.__name__ == kind and journal.exists():
                attack(journal)
                disk.struck = True


def _sessions(
    lab: VirtualLab, settings: AcquisitionSettings, disk: AttackedDisk, found: Disturbed
) -> list[Any]:
    """Go on until the session is finished, as the messages say; return the hits announced."""
    hits = []
    journal = settings.journal
    for _ in range(MOST_RUNS):
        lab.operator.begin()
        lab.channel.said.clear()
        journal.parent.mkdir(exist_ok=True)
        heard = len(lab.operator.events)
        now = replace(settings, journal=journal, resume=journal.exists())
        run_acquisition(now, lab.channel, lab.surroundings(), files=disk)
        hits += [
            event.hit
            for _, event in lab.operator.events[heard:]
            if isinstance(event, HitJudged) and event.hit.verdict.accepted
        ]
        last = lab.operator.events[-1][1]
        said = last.message if isinstance(last, Failed) else getattr(last, "reason", "")
        found.endings.append(f"{type(last).__name__}: {said}")
        if isinstance(last, Finished):
            break
        disk.refuses = None  # somebody has seen to it
        if "is safe in " in said:
            journal = Path(said.partition("is safe in ")[2].partition(": resume that")[0])
        lab.advance(2.0)
    return hits


def _recoverable(root: Path) -> set[bytes]:
    """Return the counts of all hits that a journal, a rescue or a mirror gives back."""
    found: set[bytes] = set()
    for path in root.rglob("*"):
        if not path.is_file() or path.is_symlink() or "journal" not in path.name:
            continue
        if path.name.startswith(".") or ".torn-" in path.name:
            continue
        try:
            found |= {hit.counts.tobytes() for hit in load_journal(path).hits}
        except ArmodalError:
            found |= _salvaged(path)
    return found


def _salvaged(path: Path) -> set[bytes]:
    try:
        with journal_file(path) as data:
            parts = [b"".join(s.parts()) for s in salvage(data).sessions]
    except ArmodalError:
        return set()
    return {hit.counts.tobytes() for part in parts for hit in decode_journal(part).hits}
