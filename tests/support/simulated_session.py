"""A session in the simulated laboratory, driven from outside by a scripted operator."""

from __future__ import annotations

import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from armodal.daq.commands import Stop
from armodal.daq.events import Event, Failed, Finished, HitJudged, Prompted, SessionOpened
from armodal.daq.session_machine import Prompt, PromptKind
from armodal.protocols.session.journal import read_journal
from armodal.tui.operators import Operator

PLAN = """
format = "armodal-plan-1"
name = "torture"
arm = "rv4frl"
mode = "roving-response"
fixed_point = "1"
hits_per_point = {hits}
max_attempts = 100
[sampling]
rate_hz = "51200/31"
samples = {samples}
pretrigger = 100
[trigger]
level_n = 8.0
slope = "rising"
[windows]
exponential_end = 0.03
[sensor]
mass_kg = 0.0093
[[postures]]
name = "test 1"
joints_deg = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
tolerance_deg = 0.5
points = {points}
hit_direction = [-0.383, -0.821, 0.423]
"""


class Announcing:
    """A connection that notes which hits are told to be accepted, just before they are.

    A session that is resumed tells of all accepted hits that it found.
    """

    def __init__(
        self, inner: Connection[Any, Any], note: Callable[..., None], journal: Path
    ) -> None:
        self._inner = inner
        self._note = note
        self._journal = journal

    def send(self, event: Event) -> None:
        if isinstance(event, HitJudged) and event.hit.verdict.accepted:
            self._note(event.hit)
        if isinstance(event, SessionOpened) and event.hits_before:
            found = read_journal(self._journal).hits[: event.hits_before]
            self._note(*(hit for hit in found if hit.verdict.accepted))
        self._inner.send(event)

    def recv(self) -> object:
        return self._inner.recv()

    def poll(self, timeout: float = 0.0) -> bool:
        return self._inner.poll(timeout)

    def fileno(self) -> int:
        return self._inner.fileno()


def operate(
    channel: Connection[Any, Any],
    operator: Operator,
    *,
    heard: Callable[[Event], None] = lambda event: None,
    stop_after: int | None = None,
    until_hit: bool = False,
) -> Event | None:
    """Do what a session asks until it ends; None where it ended without a word.

    After `stop_after` accepted hits the operator says stop; `until_hit` leaves the session running
    and returns the first accepted hit.
    """
    pending: Prompt | None = None
    asked_s = 0.0
    accepted = 0
    patience_s = operator.patience_s or 3600.0
    while True:
        try:
            if pending is not None and time.monotonic() - asked_s > patience_s:
                operator.act(pending)
                asked_s = time.monotonic()
            if not channel.poll(patience_s):
                continue
            event = channel.recv()
            heard(event)
            if isinstance(event, Finished | Failed):
                return event
            if isinstance(event, HitJudged) and event.hit.verdict.accepted:
                accepted += 1
                if until_hit:
                    return event
                if accepted == stop_after:
                    channel.send(Stop(reason="enough"))
            if isinstance(event, Prompted):
                command = operator.act(event.prompt)
                if command is not None:
                    channel.send(command)
                is_hit = event.prompt.kind is PromptKind.HIT
                pending, asked_s = (event.prompt if is_hit else None), time.monotonic()
        except (EOFError, ConnectionError):
            return None
