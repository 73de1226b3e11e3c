"""How long the machine has held its processors up: what a test in real time must know of it."""

import os
import threading
import time
from collections import deque

NAP_S = 0.005
WORTH_S = 0.02  # held up for less is every machine's day
MOST_PROCESSORS = 8


class HeldUpError(Exception):
    """A test in real time failed while the machine was held up: it tells nothing of the code."""


class StallWatch:
    """A thread on each processor that naps, and notes when it woke much too late."""

    def __init__(self):
        self._stalls = deque(maxlen=10_000)  # end, length
        for processor in sorted(os.sched_getaffinity(0))[:MOST_PROCESSORS]:
            threading.Thread(target=self._nap, args=(processor,), daemon=True).start()

    def longest_s(self, since_s):
        """The longest time that a processor was held up since a monotonic time."""
        return max((length for end, length in [*self._stalls] if end > since_s), default=0.0)

    def _nap(self, processor):
        os.sched_setaffinity(0, {processor})  # of this thread alone
        slept_from_s = time.monotonic()
        while True:
            time.sleep(NAP_S)
            now_s = time.monotonic()
            late_s = now_s - slept_from_s - NAP_S
            if late_s > WORTH_S:
                self._stalls.append((now_s, late_s))
            slept_from_s = now_s
