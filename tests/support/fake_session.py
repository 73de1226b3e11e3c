"""A whole session with the fake board and controller of `tests/daq/conftest.py`."""

from __future__ import annotations

import multiprocessing
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from support.simulated_session import Announcing, operate

from armodal.daq.acquisition import run_acquisition
from armodal.daq.commands import Command, Ready
from armodal.daq.events import Event
from armodal.daq.session_machine import Prompt, PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.file_layer import DISK, FileLayer

SCALE = 16.0  # lab seconds a second


class Hammer:
    """Mounts at once, and hits as soon as a whole block can lie behind the prompt."""

    patience_s = 1.0  # a block that seems to lie before the prompt is set aside

    def __init__(self, lab: Any, counts: np.ndarray) -> None:
        self._lab = lab
        self._counts = counts

    def act(self, prompt: Prompt) -> Command | None:
        if prompt.kind is PromptKind.POINT:
            return Ready()
        if prompt.kind is PromptKind.HIT:
            time.sleep(len(self._counts) / 1652.0 / SCALE)
            self._lab.board.hit(self._counts)
        return None


def settings_of(lab: Any, **changes: Any) -> AcquisitionSettings:
    """Settings of a session with these fakes."""
    given = {
        "board_port": lab.board.name,
        "can_channel": lab.controller.name,
        "arm": lab.arm,
        "plan": lab.plan,
        "journal": lab.journal,
        "still_s": 0.05,
        "time_scale": SCALE,
    }
    return AcquisitionSettings(**{**given, **changes})


def whole_session(
    lab: Any,
    counts: np.ndarray,
    *,
    files: FileLayer = DISK,
    announced: Callable[..., None] = lambda *hits: None,
    heard: Callable[[Event], None] = lambda event: None,
    **changes: Any,
) -> tuple[Event | None, int]:
    """Run a session to its end; return its last word and the exit code.

    `announced` is called with each hit just before it is told to be accepted.
    """
    lab.board.scale = lab.controller.scale = SCALE
    settings = settings_of(lab, **changes)
    ours, theirs = multiprocessing.Pipe()
    teller = Announcing(theirs, announced, settings.journal)
    codes: list[int] = []
    thread = threading.Thread(
        target=lambda: codes.append(run_acquisition(settings, teller, files=files))
    )
    thread.start()
    lab.controller.silent = False
    end = operate(ours, Hammer(lab, counts), heard=heard)
    lab.controller.silent = True  # nobody reads its line any more
    thread.join(10.0)
    for connection in (ours, theirs):
        connection.close()
    return end, codes[0]
