"""One session at a time on a port and on a journal.

A lock is a file, for its user only, that names its holder. The system's own lock on that file
(`flock`) goes with the process, however it ends; the name in it says who holds it, and decides
where the file system has no such locks.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from armodal.daq.holder import Holder, Life, read_holder, this_process
from armodal.protocols.errors import JournalError, PortError
from armodal.protocols.os_words import os_words

if sys.platform != "win32":
    import fcntl

__all__ = [
    "HeldError",
    "SessionLock",
    "lock_folder",
    "lock_journal",
    "lock_open_journal",
    "lock_port",
]

_MOST_BYTES = 4096
_NO_LOCKS = frozenset({errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL})


class HeldError(Exception):
    """Somebody holds the lock; the message follows the words "in use by"."""


class SessionLock:
    """A lock that is held until `release`, or until the process ends.

    Parameters
    ----------
    path
        The lock's file.
    shared
        Whether other machines may see it. Then a name from another machine is believed.

    Raises
    ------
    HeldError, OSError
        If somebody holds it; if the file cannot be made.

    Attributes
    ----------
    ended : Holder or None
        The process that left this lock behind without releasing it.
    """

    def __init__(self, path: Path, *, shared: bool) -> None:
        self._path = path
        self._shared = shared
        self.ended: Holder | None = None
        self._fd = self._taken()

    def release(self) -> None:
        """Let go; a second call does nothing."""
        if self._fd >= 0:
            with suppress(OSError):
                self._path.unlink()
            os.close(self._fd)
            self._fd = -1

    def _taken(self) -> int:
        """Return the descriptor of the lock's file, locked and with our name in it."""
        while True:
            fd = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
            try:
                self._check_free(fd)
                if _is_still(fd, self._path):
                    os.ftruncate(fd, 0)
                    os.pwrite(fd, this_process().encode(), 0)
                    return fd
            except BaseException:
                os.close(fd)
                raise
            os.close(fd)  # its holder released it while we looked

    def _check_free(self, fd: int) -> None:
        """Take the system's lock, or raise HeldError."""
        proven = _locked(fd)
        holder = read_holder(os.pread(fd, _MOST_BYTES, 0))
        life = Life.ENDED if holder is None else holder.life()
        # Of this machine, the system's lock tells more than the name.
        unsure = self._shared and life is Life.UNKNOWN
        if proven is False or unsure or (life is Life.LIVING and proven is None):
            raise HeldError(_said_of(holder, self._path))
        self.ended = holder


def lock_journal(path: Path) -> SessionLock:
    """Hold a journal; the lock lies hidden beside it.

    Raises
    ------
    JournalError
        If another session holds it.
    OSError
        If the folder takes no file.
    """
    try:
        return SessionLock(path.with_name(f".{path.name}.lock"), shared=True)
    except HeldError as error:
        raise JournalError(f"the journal {path} is in use by {error}") from None


def lock_open_journal(fd: int, path: Path) -> None:
    """Hold the journal itself, by whatever name it was opened; the hold goes with the descriptor.

    Raises
    ------
    JournalError
        If another session writes it, under this name or another.
    """
    if _locked(fd) is False:
        raise JournalError(
            f"the journal {path} is in use by another session, perhaps by another name of the same "
            "file; wait for it to end, or end it"
        )


def lock_port(name: str) -> SessionLock:
    """Hold a serial port, by whatever name it was given.

    Raises
    ------
    PortError
        If another session holds it, or the lock cannot be made.
    """
    digest = hashlib.sha256(os.fsencode(os.path.realpath(name))).hexdigest()[:16]
    path = lock_folder() / f"port-{digest}.lock"
    try:
        return SessionLock(path, shared=False)
    except HeldError as error:
        raise PortError(f"port {name} is in use by {error}") from None
    except OSError as error:
        raise PortError(
            f"cannot lock port {name} with {path}: {os_words(error)}; check rights and free space"
        ) from error


def lock_folder() -> Path:
    """Return the folder of the locks on ports, made if missing, for its user only.

    Raises
    ------
    PortError
        If it is somebody else's, or open to others.
    """
    runtime = Path(os.environ.get("XDG_RUNTIME_DIR", ""))
    if runtime.is_absolute() and runtime.is_dir():
        folder = runtime / "armodal"
    else:
        folder = Path(tempfile.gettempdir()) / f"armodal-{os.getuid()}"
    try:
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        found = folder.lstat()
    except OSError as error:
        raise PortError(
            f"cannot make {folder}, where ports in use are noted: {os_words(error)}; set "
            "XDG_RUNTIME_DIR to a folder of your own"
        ) from error
    private = stat.S_ISDIR(found.st_mode) and not stat.S_IMODE(found.st_mode) & 0o077
    if not private or found.st_uid != os.getuid():
        raise PortError(
            f"wanted {folder} to be a folder of this user alone, found mode "
            f"{stat.filemode(found.st_mode)} of user {found.st_uid}: remove it, or set "
            "XDG_RUNTIME_DIR to a folder of your own"
        )
    return folder


def _locked(fd: int) -> bool | None:
    """Take the system's lock: whether it was free, None where there are no such locks."""
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as error:
        if error.errno in _NO_LOCKS:
            return None
        raise
    return True


def _is_still(fd: int, path: Path) -> bool:
    """Whether the path still leads to the file that is open."""
    try:
        return os.path.samestat(os.fstat(fd), path.stat())
    except FileNotFoundError:
        return False


def _said_of(holder: Holder | None, path: Path) -> str:
    if holder is None:
        return "another session; wait for it to end"
    if holder.life() is Life.UNKNOWN:
        return (
            f"another session, of process {holder.pid} on {holder.host} since {holder.since}: end "
            f"it there, or remove {path} if that machine no longer runs it"
        )
    return (
        f"another session, of process {holder.pid} since {holder.since}; wait for it to end, or "
        "end it"
    )
