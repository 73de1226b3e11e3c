"""The session file: HDF5 derived from the journal, laid out for generic viewers.

The layout is specified in `docs/session-file.md`. A file appears whole or not at all: it is made
in memory, written beside its place, read back, compared, and only then renamed.
"""

from __future__ import annotations

import glob
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np

from armodal.protocols.errors import ArmodalError, JournalError, SessionError
from armodal.protocols.file_layer import DISK, FileLayer, write_all
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.os_words import os_words
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.hdf5_frf import (
    check_frf,
    frf_name,
    read_frf_groups,
    write_frf_groups,
)
from armodal.protocols.session.hdf5_header import (
    Provenance,
    read_header,
    read_provenance_group,
    write_header,
    write_provenance,
)
from armodal.protocols.session.hdf5_hits import read_hits, read_losses, write_hits, write_losses
from armodal.protocols.session.hdf5_tree import (
    Tree,
    add_array,
    add_group,
    add_text,
    add_texts,
    open_tree,
)
from armodal.protocols.session.journal_payloads import hit_model, loss_model
from armodal.protocols.session.membership import check_frf_membership, check_membership
from armodal.protocols.session.records import Session

__all__ = [
    "Provenance",
    "is_complete",
    "read_frfs",
    "read_provenance",
    "read_session",
    "write_session",
]

DEFINITION = "armodal-session"
FORMAT_VERSION = 1
_ENTRY = "session"
_WRITTEN_AT_ONCE = 2**20  # bytes
_NO_PID = 2**31


def write_session(
    session: Session,
    path: str | Path,
    *,
    frfs: Sequence[FrequencyResponse] = (),
    provenance: Provenance | None = None,
    files: FileLayer = DISK,
) -> None:
    """Write a session file, replacing one that is there only when the new one is proven.

    Only its user may read it. What a writer that was killed left beside it is removed.

    Parameters
    ----------
    session
        Complete or not.
    path
        Where the file shall be. The temporary file lies in the same folder.
    frfs
        FRF matrices derived from its hits, one a posture, to store with it. Those the session
        was given instead of hits are stored in any case.
    provenance
        What the session was derived from; without it, the software of the session itself and
        no journal.
    files
        What the file is written through.

    Raises
    ------
    SessionError
        If the session contradicts itself, the file cannot be written, or what was read back is
        not what was written. A file that was there before is untouched then.
    """
    target = Path(path)
    _check(session, frfs, target)
    if provenance is None:
        provenance = Provenance(journal_sha256=None, software=session.header.software)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        _remove_leftovers(target, files)
        _write(files, temporary, _image(session, frfs, provenance))
        _verify(temporary, session, frfs, provenance)
        files.replace(temporary, target)
        files.sync_folder(target.parent)
    except SessionError:
        raise
    except JournalError as error:
        raise SessionError(f"{target} is not written: {error}") from error
    except (OSError, RuntimeError, ValueError) as error:
        raise SessionError(
            f"the session file {target} cannot be written ({os_words(error)}): free or choose "
            "another place and write it again; a journal, where there is one, is untouched: "
            "`armodal recover` writes from it"
        ) from error
    finally:
        with suppress(OSError):  # gone by its renaming, or never made
            files.remove(temporary)


def read_session(path: str | Path) -> Session:
    """Read a session file, checking everything in it.

    Raises
    ------
    SessionError
        If the file is not a session file of this version, or anything in it is damaged,
        impossible or in contradiction to the rest.
    """
    with open_tree(Path(path)) as root:
        return _read_entry(_entry(root))


def read_frfs(path: str | Path) -> tuple[FrequencyResponse, ...]:
    """Read the FRF matrices of a session file; errors as `read_session`."""
    with open_tree(Path(path)) as root:
        return read_frf_groups(_entry(root))


def read_provenance(path: str | Path) -> Provenance:
    """Read what a session file was derived from; errors as `read_session`."""
    with open_tree(Path(path)) as root:
        return read_provenance_group(_entry(root))


def _check(session: Session, frfs: Sequence[FrequencyResponse], target: Path) -> None:
    """Raise SessionError if what is to be written could not be read back."""
    try:
        previous = None
        for hit in session.hits:
            hit_model(hit)
            check_membership(hit, session.header, previous)
            previous = hit
        for loss in session.losses:
            loss_model(loss)
        for frf in (*session.frfs, *frfs):
            check_frf(frf)
        for frf in session.frfs:
            check_frf_membership(frf, session)
    except ArmodalError as error:
        raise SessionError(f"{target} is not written: {error}") from error


def _image(session: Session, frfs: Sequence[FrequencyResponse], provenance: Provenance) -> bytes:
    """Return the bytes of the session file; the HDF5 library itself touches no disk."""
    with h5py.File(f"{_ENTRY}.h5", "w", driver="core", backing_store=False) as file:
        file.attrs["NX_class"] = "NXroot"
        file.attrs["default"] = _ENTRY
        file.attrs["creator"] = provenance.software
        entry = add_group(file, _ENTRY, "NXentry")
        add_text(entry, "definition", DEFINITION)
        add_array(entry, "format_version", np.array(FORMAT_VERSION, dtype=np.int64))
        write_header(entry, session.header)
        add_array(entry, "complete", np.array(session.complete, dtype=np.uint8))
        add_texts(entry, "warnings", session.warnings)
        write_hits(entry, session.header, session.hits)
        write_losses(entry, session.losses)
        write_frf_groups(entry, frfs, session.frfs)
        write_provenance(entry, provenance)
        if frfs or session.frfs:
            entry.attrs["default"] = frf_name(0)
        elif session.hits:
            entry.attrs["default"] = "first_hit"
        file.flush()
        return bytes(file.id.get_file_image())


def _write(files: FileLayer, path: Path, image: bytes) -> None:
    """Write a file, and make it durable."""
    fd = files.create(path)
    try:
        write_all(files, fd, image, at_once=_WRITTEN_AT_ONCE)
        files.sync(fd)
    finally:
        files.close(fd)


def _remove_leftovers(target: Path, files: FileLayer) -> None:
    """Remove what writers of this file that were killed left half written."""
    for part in target.parent.glob(f".{glob.escape(target.name)}.*.part"):
        pid = part.name.removesuffix(".part").rpartition(".")[2]
        if pid.isascii() and pid.isdecimal() and not _runs(int(pid)):
            files.remove(part)


def _runs(pid: int) -> bool:
    """Whether there is another process with this number."""
    if pid == os.getpid() or not 0 < pid < _NO_PID:
        return False
    if sys.platform == "win32":
        return True  # unknown: to ask for it as below would end it
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True  # it is there, and somebody else's
    return True


def _verify(
    path: Path, session: Session, frfs: Sequence[FrequencyResponse], provenance: Provenance
) -> None:
    """Raise SessionError unless the file holds what it was given."""
    with open_tree(path) as root:
        entry = _entry(root)
        difference = (
            first_difference(_read_entry(entry), session, "session")
            or first_difference(read_frf_groups(entry), (*session.frfs, *frfs), "frfs")
            or first_difference(read_provenance_group(entry), provenance, "provenance")
        )
    if difference is not None:
        raise SessionError(
            f"the session file written differs from the session at {difference}: it was thrown "
            "away; run `armodal recover` again, on another disk if it happens twice"
        )


def is_complete(path: Path) -> bool | None:
    """Whether a session file's session has all its hits; None if it is no session file.

    Reads nothing else of it: a folder of large sessions is listed at once.
    """
    try:
        with open_tree(path) as root:
            return bool(_entry(root).flags("complete", ()))
    except SessionError:
        return None


def _entry(root: Tree) -> Tree:
    if not root.has(_ENTRY):
        root.refuse(_ENTRY, "a session written by armodal", "an HDF5 file of something else")
    entry = root.group(_ENTRY)
    definition = entry.text("definition", limit=256)
    if definition != DEFINITION:
        entry.refuse("definition", repr(DEFINITION), repr(definition))
    version = int(entry.array("format_version", np.int64, ()))
    if version != FORMAT_VERSION:
        entry.refuse("format_version", f"version {FORMAT_VERSION}", f"version {version}")
    return entry


def _read_entry(entry: Tree) -> Session:
    header = read_header(entry)
    session = Session(
        header=header,
        hits=read_hits(entry, header),
        losses=read_losses(entry),
        complete=bool(entry.flags("complete", ())),
        warnings=entry.texts("warnings"),
        frfs=read_frf_groups(entry, given_only=True),
    )
    for frf in session.frfs:
        try:
            check_frf_membership(frf, session)
        except SessionError as error:
            entry.refuse("frf_count", "FRFs that belong to the session", str(error))
    return session
