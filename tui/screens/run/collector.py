"""Garbage is collected when nobody waits for the screen, and never from what stays to the end."""

from __future__ import annotations

import gc

__all__ = ["CalmCollector"]

AFTER_VERDICT_S = 0.25  # it is on the screen by then, and a record's length ahead of the next one
EVERY_S = 5.0
NEVER = 2**30  # collections of the middle generation before the oldest is looked at


class CalmCollector:
    """Python's collector of the oldest generation, at moments of the app's choice.

    Program and libraries are some hundred thousand objects. Looking at all of them takes a quarter
    of a second; Python does so every few seconds, wherever it is, and a verdict waits for it. Here
    all of them are looked at between points only, and left out until the next pause. The rest is
    looked at right after a verdict, or when none has come for a while. The young generations,
    which take a few milliseconds, are left to Python.

    It concerns the whole process: whoever begins also ends.
    """

    def __init__(self) -> None:
        self._threshold: tuple[int, int, int] | None = None  # Python's, while it is put aside
        self._next_s = 0.0
        self._pause = False

    def begin(self, now_s: float) -> None:
        """Take over, and leave out what is there now; may be called again."""
        if self._threshold is None:
            self._threshold = gc.get_threshold()
            young, middle, _ = self._threshold
            gc.set_threshold(young, middle, NEVER)
        gc.unfreeze()
        gc.collect()
        gc.freeze()
        self._next_s = now_s + EVERY_S
        self._pause = False

    def verdict_came(self, now_s: float) -> None:
        """Collect when the verdict is on the screen, if it would soon be time anyway."""
        if self._next_s - now_s < EVERY_S / 2.0:
            self._next_s = now_s + AFTER_VERDICT_S

    def pause_came(self, now_s: float) -> None:
        """Look at everything soon: no verdict can come for a while."""
        self._pause = True
        self._next_s = now_s + AFTER_VERDICT_S

    def turn(self, now_s: float) -> bool:
        """Collect if it is time, and return whether it was; call it a few times a second."""
        if self._threshold is None or now_s < self._next_s:
            return False
        if self._pause:
            self.begin(now_s)
        else:
            gc.collect()
            self._next_s = now_s + EVERY_S
        return True

    def end(self) -> None:
        """Give the collector back to Python."""
        if self._threshold is not None:
            gc.set_threshold(*self._threshold)
            gc.unfreeze()
            self._threshold = None
