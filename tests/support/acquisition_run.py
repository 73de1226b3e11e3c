"""An acquisition in a thread, with its operator's end of the pipe in the test's hand."""

from __future__ import annotations

import dataclasses
import multiprocessing
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
import pytest

from armodal.daq.acquisition import run_acquisition
from armodal.daq.commands import Ready, Stop
from armodal.daq.events import Failed, HitJudged, Noted, Prompted
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings


class Run:
    """An acquisition in a thread, and its operator's end of the pipe."""

    def __init__(self, lab: Any, **changes: Any) -> None:
        settings = AcquisitionSettings(
            board_port=lab.board.name,
            can_channel=lab.controller.name,
            arm=lab.arm,
            plan=lab.plan,
            journal=lab.journal,
            still_s=0.05,
        )
        self.settings = dataclasses.replace(settings, **changes)
        self.ours, theirs = multiprocessing.Pipe()
        self.code: int | None = None

        def body() -> None:
            self.code = run_acquisition(self.settings, theirs)
            theirs.close()

        self.thread = threading.Thread(target=body)
        self.thread.start()
        self.seen: list[Any] = []
        self.read_to = 0

    def until(self, wanted: Callable[[Any], bool], timeout_s: float = 60.0) -> Any:
        for event in self.seen[self.read_to :]:
            self.read_to += 1
            if wanted(event):
                return event
        end_s = time.monotonic() + timeout_s
        while self.ours.poll(max(end_s - time.monotonic(), 0.0)):
            event = self.ours.recv()
            self.seen.append(event)
            self.read_to = len(self.seen)
            if wanted(event):
                return event
            if isinstance(event, Failed):
                pytest.fail(event.message)
        return pytest.fail(f"the event did not come; seen: {self.seen[-8:]}")

    def prompt(self, kind: PromptKind) -> Any:
        return self.until(lambda e: isinstance(e, Prompted) and e.prompt.kind is kind).prompt

    def judged(self) -> Any:
        return self.until(lambda e: isinstance(e, HitJudged)).hit

    def noted(self, words: str) -> Any:
        return self.until(lambda e: isinstance(e, Noted) and words in e.text)

    def failure(self) -> Any:
        failed = self.until(lambda e: isinstance(e, Failed))
        self.thread.join(5.0)
        assert self.code == 2
        return failed

    def ready(self) -> Any:
        self.prompt(PromptKind.POINT)
        self.ours.send(Ready())
        return self.prompt(PromptKind.HIT)

    def end(self) -> None:
        with suppress(OSError):  # it may just have ended by itself
            self.ours.send(Stop())
        self.thread.join(8.0)
        self.ours.close()
        assert not self.thread.is_alive()


def strike(lab: Any, counts: np.ndarray) -> int:
    """Hit, once the block's whole time has passed since the prompt, as it must have."""
    time.sleep(len(counts) / 1652.0 / lab.board.scale)
    return lab.board.hit(counts)
