"""Sessions one after the other in one process leave nothing behind."""

from __future__ import annotations

import gc
import weakref

from armodal.daq.session_machine import PromptKind


class _Round:
    def __init__(self):
        self.itself = self


def test_what_an_earlier_session_left_out_of_collection_is_collected(start, freezing):
    left = _Round()
    gc.freeze()  # as that session did
    gone = weakref.ref(left)
    del left
    start().prompt(PromptKind.POINT)
    assert gone() is None
