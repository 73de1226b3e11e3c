"""A disk that notes every change, and the disks that a stop or a power cut could have left.

The model of a power cut is a pessimistic one, after Pillai et al., OSDI 2014 ("All file systems
are not created equal"): what was synced is there; of what was not, every sector shows any version
it had since, or bytes nobody wrote, in any order; lengths and names are each old or new. The one
thing assumed is that a single sector is written wholly or not at all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from armodal.protocols.file_layer import Disk
from armodal.protocols.session.records import Hit

# Which point it is, the files there, and the hits announced by then.
Point = tuple[str, dict[str, bytes], dict[int, Hit]]


@dataclass(frozen=True)
class Change:
    """One operation on the disk, or an announcement between two."""

    kind: str  # create, write, rewrite, sync, unsynced, cut, replace, remove, folder, announce
    name: str = ""
    inode: int = -1
    data: bytes = b""
    size: int = 0
    target: str = ""
    hits: tuple[Hit, ...] = ()


class RecordingDisk(Disk):
    """The real disk, with a list of what was done to it.

    `there` are names of files that an earlier process has left.
    """

    def __init__(self, *, there: tuple[str, ...] = ()) -> None:
        self.log: list[Change] = []
        self._inodes: dict[int, int] = {}  # open descriptor: inode
        self._of_name = {name: inode for inode, name in enumerate(there, start=1)}
        self._made = len(there)

    def announce(self, *hits: Hit) -> None:
        """Note that somebody has been told that hits are accepted."""
        self.log.append(Change("announce", hits=hits))

    def create(self, path: Path) -> int:
        fd = super().create(path)
        self._made += 1
        self._inodes[fd] = self._of_name[path.name] = self._made
        self.log.append(Change("create", path.name, self._made))
        return fd

    def open(self, path: Path) -> int:
        fd = super().open(path)
        self._inodes[fd] = self._of_name[path.name]
        return fd

    def write(self, fd: int, data: bytes | memoryview) -> int:
        written = super().write(fd, data)
        self.log.append(Change("write", inode=self._inodes[fd], data=bytes(data[:written])))
        return written

    def rewrite(self, path: Path, data: bytes, at: int) -> None:
        super().rewrite(path, data, at)
        self.log.append(Change("rewrite", inode=self._of_name[path.name], size=at))

    def sync(self, fd: int) -> None:
        super().sync(fd)
        self.log.append(Change("sync", inode=self._inodes[fd]))

    def forgotten(self, fd: int) -> None:
        """Note that a sync was refused."""
        self.log.append(Change("unsynced", inode=self._inodes[fd]))

    def cut(self, fd: int, size: int) -> None:
        super().cut(fd, size)
        self.log.append(Change("cut", inode=self._inodes[fd], size=size))

    def replace(self, source: Path, target: Path) -> None:
        super().replace(source, target)
        self._of_name[target.name] = self._of_name.pop(source.name)
        self.log.append(Change("replace", source.name, target=target.name))

    def remove(self, path: Path) -> None:
        super().remove(path)
        self.log.append(Change("remove", path.name))

    def sync_folder(self, path: Path) -> None:
        super().sync_folder(path)
        self.log.append(Change("folder"))

    def found(self, path: Path) -> None:
        """Take bytes behind a file's end, left by a killed session and never synced."""
        inode = self._of_name[path.name]
        size = len(replayed(self.log).files[inode].now)
        self.log.append(Change("write", inode=inode, data=path.read_bytes()[size:]))


@dataclass
class _File:
    """Versions of a file since the last sync, the first one durable.

    What a refused sync held is forgotten by the system: no later sync writes it, until it is
    written again. `stuck` are the versions from the refusal on.
    """

    versions: list[bytes] = field(default_factory=lambda: [b""])
    stuck: list[bytes] = field(default_factory=list)

    @property
    def now(self) -> bytes:
        return self.versions[-1]

    def synced(self) -> None:
        self.versions = [*self.stuck, self.now]

    def forget_stuck(self, at: int) -> None:
        """Everything from byte `at` on was written again, or is gone."""
        if self.stuck and at <= len(self.stuck[0]):
            self.stuck = []


@dataclass
class DiskState:
    """Files and names after some changes, and what of them is durable."""

    files: dict[int, _File] = field(default_factory=dict)
    names: dict[str, int] = field(default_factory=dict)
    durable_names: dict[str, int] = field(default_factory=dict)
    pending_names: list[Mapping[str, int | None]] = field(default_factory=list)
    announced: dict[int, Hit] = field(default_factory=dict)

    def apply(self, change: Change) -> None:
        if change.kind == "create":
            self.files[change.inode] = _File()
            self._rename({change.name: change.inode})
        elif change.kind == "write":
            file = self.files[change.inode]
            file.versions.append(file.now + change.data)
        elif change.kind == "cut":
            file = self.files[change.inode]
            file.versions.append(file.now[: change.size])
            file.forget_stuck(change.size)
        elif change.kind == "rewrite":
            self.files[change.inode].forget_stuck(change.size)
        elif change.kind == "sync":
            self.files[change.inode].synced()
        elif change.kind == "unsynced":
            file = self.files[change.inode]
            file.stuck = list(file.versions)
        elif change.kind == "replace":
            self._rename({change.target: self.names[change.name], change.name: None})
        elif change.kind == "remove":
            self._rename({change.name: None})
        elif change.kind == "folder":
            self.durable_names = dict(self.names)
            self.pending_names = []
        else:
            self.announced |= {hit.number: hit for hit in change.hits}

    def _rename(self, changed: Mapping[str, int | None]) -> None:
        self.names = _renamed(self.names, changed)
        self.pending_names.append(changed)

    def stopped(self, prefix: bytes = b"", inode: int = -1) -> dict[str, bytes]:
        """Files after a kill: all that was done, and the beginning of a write."""
        return {
            name: self.files[number].now + (prefix if number == inode else b"")
            for name, number in self.names.items()
        }

    def after_power_cut(self, rng: np.random.Generator, sector: int) -> dict[str, bytes]:
        """Files after a power cut: one of the many that may be."""
        names = self.durable_names
        for changed in self.pending_names:
            if rng.random() < 0.5:
                names = _renamed(names, changed)
        return {
            name: _mixed(self.files[inode].versions, rng, sector) for name, inode in names.items()
        }


def _renamed(names: Mapping[str, int], changed: Mapping[str, int | None]) -> dict[str, int]:
    return {name: inode for name, inode in {**names, **changed}.items() if inode is not None}


def _mixed(versions: list[bytes], rng: np.random.Generator, sector: int) -> bytes:
    """Mix the versions of a file, sector by sector; the first one is durable."""
    if len(versions) == 1:
        return versions[0]
    durable = versions[0]
    sizes = {len(version) for version in versions}
    # A file system lengthens a file block by block, too.
    low, high = min(sizes), max(sizes)
    sizes |= {int(size) for size in rng.integers(low, high + 1, 2) // sector * sector if size > low}
    size = int(rng.choice(sorted(sizes)))
    mixed = bytearray(size)
    for at in range(0, size, sector):
        end = min(at + sector, size)
        version = versions[int(rng.integers(len(versions)))]
        part = version[at:end]
        mixed[at : at + len(part)] = part
        if at >= len(durable) and rng.random() < 0.1:  # a block that belonged to something else
            mixed[at:end] = rng.bytes(end - at)
    return bytes(mixed)


def replayed(log: list[Change]) -> DiskState:
    """Return the disk after all changes."""
    state = DiskState()
    for change in log:
        state.apply(change)
    return state


def kill_points(log: list[Change], rng: np.random.Generator, *, places: int) -> Iterator[Point]:
    """Yield the disk of a kill at every change, within writes at up to `places` more."""
    state = DiskState()
    for index, change in enumerate(log):
        if change.kind != "announce":
            yield f"before change {index} ({change.kind})", state.stopped(), dict(state.announced)
        if change.kind == "write":
            for n in _places(len(change.data), places, rng):
                yield (
                    f"{n} of {len(change.data)} bytes into change {index}",
                    state.stopped(change.data[:n], change.inode),
                    dict(state.announced),
                )
        state.apply(change)
    yield "after the last change", state.stopped(), dict(state.announced)


def _places(size: int, most: int, rng: np.random.Generator) -> list[int]:
    """Return where to stop within a write: the edges of its fields, and anywhere."""
    edges = [n for n in (1, 7, 8, 12, size - 5, size - 4, size - 1) if 0 < n < size]
    inside = rng.integers(1, size, most).tolist() if size > 1 else []
    return sorted({*edges[:most], *inside[: max(most - len(edges), 0)]})


def power_cuts(
    log: list[Change], rng: np.random.Generator, *, each: int, first: int = 0
) -> Iterator[Point]:
    """Yield `each` disks of a power cut after every change that leaves something unsynced.

    Changes before the `first` are not looked at.
    """
    state = DiskState()
    for index, change in enumerate(log):
        state.apply(change)
        unsynced = state.pending_names or any(len(f.versions) > 1 for f in state.files.values())
        if index < first:
            continue
        if change.kind == "announce" and not unsynced:
            yield f"after change {index}", state.stopped(), dict(state.announced)
        if not unsynced:
            continue
        for n in range(each):
            sector = 512 if n % 2 else 4096
            yield (
                f"after change {index} ({change.kind}), {sector} B, draw {n}",
                state.after_power_cut(rng, sector),
                dict(state.announced),
            )
