"""A library that makes room for what a file only says is refused it, and nobody else is."""

from __future__ import annotations

import subprocess
import sys
import threading
from contextlib import suppress

import pytest

from armodal.protocols.memory_bound import address_space_bytes, at_most_more, nothing_bounded

resource = pytest.importorskip("resource")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux bounds this")

MB = 10**6
TELL = "import resource; print(resource.getrlimit(resource.RLIMIT_AS)[0])"


def limit():
    return resource.getrlimit(resource.RLIMIT_AS)[0]


def test_what_is_beyond_the_bound_is_refused_and_what_is_within_is_given():
    with at_most_more(200 * MB):
        assert len(bytearray(100 * MB)) == 100 * MB
        with pytest.raises(MemoryError):
            bytearray(300 * MB)
    assert len(bytearray(300 * MB)) == 300 * MB


def test_the_limit_is_as_before_however_the_block_ends():
    before = limit()
    with suppress(ValueError), at_most_more(MB):
        assert limit() != before
        raise ValueError
    assert limit() == before


def test_a_lower_limit_of_the_users_stays():
    allowed = address_space_bytes() + 100 * MB
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (allowed, before[1]))
    try:
        with at_most_more(1000 * MB):
            assert limit() == allowed
        assert limit() == allowed
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def test_threads_that_bound_at_once_leave_no_bound():
    before, begun = limit(), threading.Barrier(4)

    def often():
        begun.wait()
        for _ in range(200):
            with at_most_more(500 * MB), at_most_more(200 * MB):
                pass

    threads = [threading.Thread(target=often) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert limit() == before


def test_a_process_started_where_nothing_is_bounded_has_no_bound_of_another_thread():
    before, bounded, may_end = limit(), threading.Event(), threading.Event()

    def bound():
        with at_most_more(900 * MB):
            bounded.set()
            may_end.wait()

    def start():
        with nothing_bounded():
            done = subprocess.run([sys.executable, "-c", TELL], capture_output=True, check=True)
        told.append(int(done.stdout))

    told = []
    threads = [threading.Thread(target=bound), threading.Thread(target=start)]
    threads[0].start()
    bounded.wait()
    threads[1].start()
    assert limit() != before
    may_end.set()
    for thread in threads:
        thread.join()
    assert told == [before]
