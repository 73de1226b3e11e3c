"""Cut the power of a block device under ext4 while a journal is written, again and again.

    python bench/torture_block_device.py [--cuts 200] [--seed 1]

A small ext4 lies on a loop device. A fork of this process appends hits and tells of each one that
is durable. At a random moment it is stopped, and the device is copied as it is: what the kernel
holds and has not written is lost, as when the power goes. The copy is mounted, which replays the
file system's own journal, and every hit told of must be in it. Needs root and loop devices; without
them that is said, and nothing is tried.

On the same device ext4 turns itself read-only under the writer, as it does when a disk fails, and a
small file system in memory (tmpfs) is written until it is full.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import BinaryIO

import numpy as np
from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.accepted_hits import quick_folder
from support.fault_runs import run_seed

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.errors import ArmodalError
from armodal.protocols.file_layer import Disk
from armodal.protocols.session.journal import decode_journal, encode_hit, read_journal

WANTED = 200
REFUSED = 40  # times a file system turns read-only, or full
REFUSING = {"ext4": "ext4 that turns itself read-only", "tmpfs": "tmpfs that fills up"}
IMAGE_BYTES = 64 * 2**20
SMALL_BYTES = 2**20
LONGEST_S = 0.3  # of writing before a cut
LAZY = 3  # cuts of a journal whose sync does nothing: they must find that
COUNTED = 4  # bytes of a number told


class Lazy(Disk):
    """A disk that says it has synced, and has not."""

    def sync(self, fd: int) -> None:
        pass

    def sync_folder(self, path: Path) -> None:
        pass


def write(folder: Path, source: Path, files: Disk, told: int) -> None:
    """Append hits for ever, and tell the number of each one that counts."""
    journal = decode_journal(source.read_bytes())
    writer = JournalWriter.create(folder / "session.journal", journal.header, files=files)
    for number in count(1):
        hit = replace(journal.hits[number % len(journal.hits)], number=number)
        writer.append(encode_hit(hit))
        os.write(told, number.to_bytes(COUNTED, "little"))


def writing(folder: Path, source: Path, files: Disk) -> tuple[int, BinaryIO]:
    """Fork a process that writes; return its number, and what it tells."""
    reading, told = os.pipe()
    process = os.fork()
    if process == 0:
        try:
            os.close(reading)
            write(folder, source, files, told)
        finally:
            os._exit(1)
    os.close(told)
    return process, os.fdopen(reading, "rb")


def run(*command: str | Path) -> None:
    """Run a command of the system."""
    subprocess.run([str(word) for word in command], check=True, capture_output=True)


def cut(
    root: Path, source: Path, rng: np.random.Generator, *, lazily: bool = False
) -> tuple[int, str]:
    """Write, cut the power, mount what is left; return how many hits were told, what is lost."""
    image, left, place = root / "disk", root / "left", root / "mounted"
    with image.open("wb") as file:
        file.truncate(IMAGE_BYTES)
    run("mkfs.ext4", "-q", "-F", image)
    place.mkdir(exist_ok=True)
    run("mount", "-o", "loop", image, place)
    try:
        process, telling = writing(place, source, Lazy() if lazily else Disk())
        with telling:
            said = telling.read(COUNTED)  # it has begun
            time.sleep(float(rng.uniform(0.0, LONGEST_S)))
            os.kill(process, signal.SIGSTOP)
            os.waitid(os.P_PID, process, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
            shutil.copy(image, left)
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            said += telling.read()
    finally:
        run("umount", place)
    run("mount", "-o", "loop", left, place)
    try:
        return what_is_lost(said, place, source)
    finally:
        run("umount", place)


def refused(root: Path, source: Path, rng: np.random.Generator, *, kind: str) -> tuple[int, str]:
    """Write until the file system takes no more; return as `cut` does."""
    image, place = root / "disk", root / "mounted"
    place.mkdir(exist_ok=True)
    if kind == "ext4":
        with image.open("wb") as file:
            file.truncate(IMAGE_BYTES)
        run("mkfs.ext4", "-q", "-F", image)
        run("mount", "-o", "loop", image, place)
    else:
        run("mount", "-t", "tmpfs", "-o", f"size={SMALL_BYTES}", "tmpfs", place)
    try:
        process, telling = writing(place, source, Disk())
        with telling:
            said = telling.read(COUNTED)
            if kind == "ext4":
                time.sleep(float(rng.uniform(0.0, LONGEST_S)))
                run("mount", "-o", "remount,abort", place)
            said += telling.read()  # until it ends by itself
            os.waitpid(process, 0)
        if kind == "ext4":
            run("umount", place)
            run("mount", "-o", "loop", image, place)
        return what_is_lost(said, place, source)
    finally:
        run("umount", place)


def refused_often(
    root: Path, source: Path, rng: np.random.Generator, *, kind: str
) -> tuple[int, int]:
    """Return how many hits were told of in all, and how many times one was lost."""
    hits = times = 0
    for number in range(REFUSED):
        n, lost = refused(root, source, rng, kind=kind)
        hits, times = hits + n, times + bool(lost)
        if lost:
            print(f"{kind}, time {number}: told of {n}, lost {lost}", flush=True)
    return hits, times


def what_is_lost(said: bytes, place: Path, source: Path) -> tuple[int, str]:
    """Return how many hits were told of, and which of them are not there."""
    last = int.from_bytes(said[-COUNTED:], "little")
    try:
        wanted = decode_journal(source.read_bytes()).hits
        found = {hit.number: hit for hit in read_journal(place / "session.journal").hits}
        lost = [
            n
            for n in range(1, last + 1)
            if n not in found or not np.array_equal(found[n].counts, wanted[n % len(wanted)].counts)
        ]
    except (ArmodalError, OSError) as error:
        return last, str(error)
    return last, f"{len(lost)} hits, {lost[:3]} ..." if lost else ""


def can_mount() -> bool:
    """Whether this process may mount images."""
    tools = all(shutil.which(tool) for tool in ("mkfs.ext4", "mount", "losetup"))
    return tools and os.geteuid() == 0 and Path("/dev/loop-control").exists()


def main() -> int:
    """Cut again and again; print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cuts", type=int, default=WANTED)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if not can_mount():
        print("no root, or no loop devices, on this machine: no block device was cut")
        return 0
    hits = wrong = 0
    with quick_folder() as folder, tempfile.TemporaryDirectory() as kept:
        source = Path(kept) / "source.journal"
        source.write_bytes(run_seed(0, script=((), ())).journal)
        for number in range(given.cuts):
            rng = np.random.default_rng((given.seed, number))
            n, lost = cut(Path(folder), source, rng)
            hits += n
            if lost:
                wrong += 1
                print(f"cut {number}: told of {n}, lost {lost}", flush=True)
        rng = np.random.default_rng(given.seed)
        ended = [
            (what, refused_often(Path(folder), source, rng, kind=kind))
            for kind, what in REFUSING.items()
        ]
        lazy = [cut(Path(folder), source, rng, lazily=True)[1] for _ in range(LAZY)]
    return told(
        [
            Figure("power cuts of a block device under ext4", str(given.cuts), str(WANTED),
                   given.cuts >= WANTED),
            Figure("... hits told to be durable before", str(hits), "1", hits > 0),
            Figure("... cuts after which one was lost", str(wrong), "0", not wrong),
            Figure(f"... where sync does nothing, of {LAZY} cuts", str(sum(map(bool, lazy))),
                   str(LAZY), all(lazy)),
            *(
                Figure(f"{what}, {REFUSED} times: times a hit told of was lost, of {n:,} hits",
                       str(lost), "0", lost == 0 < n)
                for what, (n, lost) in ended
            ),
        ]
    )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
