"""Who holds something: a process that can be told from a later one with the same number."""

from __future__ import annotations

import json
import os
import socket
import subprocess
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path

__all__ = ["Holder", "Life", "read_holder", "this_process"]

_STARTED_FIELD = 22  # of /proc/PID/stat, counted from 1: start of the process, ticks since boot
_FIELDS_AFTER_NAME = 3  # the first field behind the command's name
_LONGEST = 256


class Life(StrEnum):
    """What is known of a process."""

    LIVING = "living"
    ENDED = "ended"
    UNKNOWN = "unknown"  # it is, or was, on another machine


@dataclass(frozen=True, slots=True, kw_only=True)
class Holder:
    """A process, told apart by its number, its start and the boot it belongs to."""

    pid: int
    started: str  # the system's word for it; empty where it has none
    boot_id: str  # of the machine's run since it was switched on; empty where it has none
    host: str
    since: str  # ISO 8601, UTC: for people

    def life(self) -> Life:
        """Whether this very process still runs."""
        if self.boot_id != _boot_id():
            # Either this machine was switched off since, or it is another one.
            return Life.ENDED if self.host == socket.gethostname() else Life.UNKNOWN
        same = _exists(self.pid) and _started(self.pid) == self.started
        return Life.LIVING if same else Life.ENDED

    def encode(self) -> bytes:
        """Return one line of JSON."""
        return json.dumps(asdict(self)).encode() + b"\n"


def this_process() -> Holder:
    """Return who we are."""
    return Holder(
        pid=os.getpid(),
        started=_started(os.getpid()),
        boot_id=_boot_id(),
        host=socket.gethostname(),
        since=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def read_holder(data: bytes) -> Holder | None:
    """Return the holder a lock file tells of, None where it tells of none."""
    try:
        told = json.loads(data)
        pid = told["pid"]
        words = [told[name] for name in ("started", "boot_id", "host", "since")]
    except (ValueError, LookupError, TypeError, RecursionError):
        return None
    if type(pid) is not int or not 0 < pid < 2**31:
        return None
    if not all(isinstance(word, str) and len(word) < _LONGEST for word in words):
        return None
    started, boot_id, host, since = words
    return Holder(pid=pid, started=started, boot_id=boot_id, host=host, since=since)


def _exists(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True  # it is there, and somebody else's
    return True


def _started(pid: int) -> str:
    stat = Path(f"/proc/{pid}/stat")
    try:
        # The command's name may hold blanks and brackets; the last bracket closes it.
        fields = stat.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        return fields[_STARTED_FIELD - _FIELDS_AFTER_NAME]
    except (OSError, IndexError):
        return _asked("/bin/ps", "-o", "lstart=", "-p", str(pid))


def _boot_id() -> str:
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="utf-8").strip()
    except OSError:
        return _asked("/usr/sbin/sysctl", "-n", "kern.bootsessionuuid")


def _asked(*command: str) -> str:
    """Return what a system without /proc says, empty where it says nothing."""
    try:
        said = subprocess.run(  # noqa: S603 - fixed programs, and numbers as arguments
            command, capture_output=True, text=True, timeout=2.0, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return said.stdout.strip()
