"""Processes that long work runs on, and that end with it when it is stopped."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import wait
from threading import Thread

__all__ = ["worker_processes"]


@contextmanager
def worker_processes(workers: int) -> Iterator[Executor]:
    """Yield an executor on further processes, which are ended at once if what is inside fails.

    A terminal sends Ctrl-C to every process. These leave it to the one that began them: else each
    would print where it was. They end too where that one is killed. To be called from the main
    thread.
    """
    others = set(active_children())
    executor = ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_end_with_parent
    )
    try:
        _start_all(executor, workers)
        yield executor
    except BaseException:
        for process in set(active_children()) - others:
            process.terminate()
        # Without them this is done at once. A thread of the executor's that were still at it would
        # meet the interpreter's end, and now and then write to a pipe that is closed.
        executor.shutdown(cancel_futures=True)
        raise
    executor.shutdown()


def _start_all(executor: Executor, workers: int) -> None:
    """Start the processes while Ctrl-C is ignored, which a process that is started inherits."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        for _ in range(workers):  # each starts one, since none is ready that soon
            executor.submit(_nothing)
    finally:
        signal.signal(signal.SIGINT, before)


def _end_with_parent() -> None:
    """Watch, in a process that was started, for the one that began it: it may be killed."""
    parent = parent_process()
    if parent is not None:
        Thread(target=_end_after, args=(parent.sentinel,), daemon=True).start()


def _end_after(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)


def _nothing() -> None:
    """Work that is done when a process has started."""
