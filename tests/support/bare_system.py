"""`armodal` on a system as bare as Windows: run as a program, with command lines on stdin.

What Windows lacks is taken away before armodal is imported: modules, and names of `os`, `signal`,
`select` and `socket`. Libraries of others are loaded before, since there they take other ways.

Reads {"without": [modules], "commands": [[argument, ...], ...], "review": [sessions]}, writes
{"commands": [[code, stdout, stderr], ...], "review": [[modes of a posture, ...], ...]}.
"""

from __future__ import annotations

import asyncio
import importlib
import json
import os
import select
import shutil
import signal
import socket
import sys
from collections.abc import Iterable
from importlib.abc import MetaPathFinder
from pathlib import Path

MODULES = (
    "_curses _posixshmem crypt curses fcntl grp nis ossaudiodev posix pty pwd readline resource "
    "spwd syslog termios tty"
)
NAMES = {
    os: (
        "O_ACCMODE O_ASYNC O_CLOEXEC O_DIRECTORY O_DSYNC O_NDELAY O_NOCTTY O_NOFOLLOW O_NONBLOCK "
        "O_SYNC chown chroot confstr ctermid fchdir fchown fdatasync fork forkpty getegid geteuid "
        "getgid getgroups getloadavg getpgid getpgrp getpriority getresuid getsid getuid "
        "initgroups killpg lchown lockf login_tty mkfifo mknod nice openpty pathconf pipe2 "
        "posix_fadvise posix_openpt posix_spawn pread preadv pwrite pwritev register_at_fork "
        "sched_get_priority_max sched_getaffinity sched_param sched_setaffinity "
        "sched_setscheduler sched_yield sendfile setgid setpgid setpriority setsid "
        "setuid statvfs sync sysconf tcgetpgrp tcsetpgrp ttyname uname wait wait3 wait4"
    ),
    signal: (
        "ITIMER_REAL SIGALRM SIGCHLD SIGCONT SIGHUP SIGIO SIGKILL SIGPIPE SIGQUIT SIGSTOP SIGTSTP "
        "SIGUSR1 SIGUSR2 SIGWINCH alarm getitimer pause pthread_kill pthread_sigmask setitimer "
        "siginterrupt sigpending sigtimedwait sigwait sigwaitinfo"
    ),
    select: "POLLERR POLLHUP POLLIN POLLNVAL POLLOUT epoll kqueue poll",
    socket: "AF_UNIX CMSG_LEN SCM_RIGHTS recv_fds send_fds",
}
LIBRARIES = (
    "concurrent.futures.process multiprocessing.connection multiprocessing.popen_spawn_posix "
    "can cantools click cobs.cobs h5py jinja2 numpy plotly.graph_objects pydantic pyuff "
    "rich.console rich.progress rich.table scipy.io scipy.linalg scipy.optimize scipy.signal "
    "scipy.sparse scipy.stats serial textual.app textual.drivers.linux_driver textual.widgets "
    "tomlkit typer"
)


_LONG_S = 60.0  # for a session of one posture: what goes wrong in a thread must end it


class _Lacking(MetaPathFinder):
    """Says of some modules that they are not there."""

    def __init__(self, names: Iterable[str]) -> None:
        self._names = frozenset(names)

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> None:
        """Refuse a module that this system lacks; leave every other to the next finder."""
        if fullname in self._names:
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)


def take_away(without: Iterable[str]) -> None:
    """Take away what Windows has not, and the modules in `without`."""
    for name in LIBRARIES.split():
        importlib.import_module(name)
    # No function there takes a folder that is open: `shutil` looks once, as it is loaded.
    os.supports_dir_fd.clear()
    os.supports_fd.clear()
    importlib.reload(shutil)
    if hasattr(os, "process_cpu_count"):  # from 3.13 on, which asks Unix for its affinity
        os.process_cpu_count = os.cpu_count
    gone = {*MODULES.split(), *without}
    for name in gone:
        sys.modules.pop(name, None)
    sys.meta_path.insert(0, _Lacking(gone))
    for module, names in NAMES.items():
        for name in names.split():
            if hasattr(module, name):
                delattr(module, name)
    sys.platform = "win32"


async def _reviewed(path: str) -> list[int]:
    """Open a session in `armodal review`; return how many modes it shows in each posture."""
    app = importlib.import_module("armodal.tui.screens.review.app").ReviewApp(Path(path))
    async with asyncio.timeout(_LONG_S), app.run_test() as pilot:
        while app.state is None or any(
            view.model is None and not view.problem for view in app.state.views
        ):
            await pilot.pause(0.02)
        return [len(view.picks) for view in app.state.views]


def main() -> None:
    """Run every command line in this process, then look at every session."""
    asked = json.load(sys.stdin)
    with asyncio.Runner() as runner:
        runner.get_loop()  # Unix's own loop, made while it can be
        take_away(asked["without"])
        command = importlib.import_module("support.command")
        told = {
            "commands": [command.armodal(*arguments) for arguments in asked["commands"]],
            "review": [runner.run(_reviewed(path)) for path in asked["review"]],
        }
    json.dump(told, sys.stdout)


if __name__ == "__main__":
    main()
