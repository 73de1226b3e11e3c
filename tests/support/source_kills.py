"""Sessions on each source of samples that are killed anywhere, or whose device is.

What the acquisition has told of is compared with what its journal holds; then the session is
resumed and killed again.
"""

from __future__ import annotations

import math
import os
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from support.accepted_hits import missing
from support.forked_acquisition import ForkedAcquisition, fork_acquisition
from support.reach_plan import reach_plan
from support.source_devices import RATE_HZ, SOURCES

from armodal.daq.commands import Ready, StatedPosture
from armodal.daq.events import Failed, Finished, HitJudged, Prompted, SessionOpened
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import JournalError
from armodal.protocols.session.journal import read_journal
from armodal.protocols.session.recovery import rebuild

HIT_EVERY_S = 0.2
LONGEST_S = 0.8  # from the first hit asked for to the kill: a few hits
DEVICE_LOST_WITHIN_S = 30.0  # a loaded machine; the device itself is missed after two seconds


@dataclass
class Tally:
    """What came of kills: hits that were told of, of these the accepted, and what was wrong."""

    kills: int = 0
    devices_killed: int = 0
    judged: int = 0
    accepted: int = 0
    wrong: list[str] = field(default_factory=list)


class KilledSession:
    """One journal on one source, killed and resumed again and again."""

    def __init__(self, name: str, folder: Path, rng: np.random.Generator) -> None:
        self._start, self._name = SOURCES[name], name
        self._folder, self._rng = folder, rng
        self._arm = load_arm("ur5")
        self._plan = reach_plan(rate_hz=RATE_HZ, samples=2048, pretrigger=256)
        self._journal = folder / "killed.journal"
        self._told: dict[int, object] = {}
        self._device: subprocess.Popen[str] | None = None
        self._started = False
        self.tally = Tally()

    def close(self) -> None:
        """Let go of the device."""
        if self._device is not None:
            self._device.kill()
            self._device.wait()
            for stream in (self._device.stdin, self._device.stdout):
                if stream is not None:
                    stream.close()
        self._device, self._started = None, False

    def kill_once(self) -> None:
        """Run the session up to a kill at a drawn time; compare what is left."""
        if not self._started:
            text, self._device = self._start(self._folder, HIT_EVERY_S, 20.0)
            (self._folder / "source.toml").write_text(text, encoding="utf-8")
            self._started = True
        settings = AcquisitionSettings(
            board_port=str(self._folder / "source.toml"),
            told_tolerance_rad=math.radians(0.2),
            arm=self._arm,
            plan=self._plan,
            journal=self._journal,
            resume=self._journal.exists(),
        )
        of_device = self._device is not None and self._rng.random() < 1 / 3
        acquisition = fork_acquisition(settings, self._folder / "stderr")
        try:
            self._run(acquisition, of_device=of_device)
        finally:
            acquisition.end()
        self._compare()
        self.tally.kills += 1
        if of_device:
            self.tally.devices_killed += 1
            self.close()

    def _run(self, acquisition: ForkedAcquisition, *, of_device: bool) -> None:
        channel, kill_at_s, killed_s = acquisition.channel, math.inf, math.inf
        while True:
            now_s = time.monotonic()
            if now_s > kill_at_s and killed_s == math.inf:
                killed_s = now_s
                victim = self._device if of_device else acquisition.process
                assert victim is not None
                assert victim.pid is not None
                os.kill(victim.pid, signal.SIGKILL)
            if now_s - killed_s > DEVICE_LOST_WITHIN_S:
                self.tally.wrong.append(f"{self._name}: the killed device was not missed")
                return
            try:
                if not channel.poll(max(min(kill_at_s - now_s, 0.05), 0.0)):
                    continue
                event = channel.recv()
            except (EOFError, OSError):
                if killed_s == math.inf:
                    self.tally.wrong.append(f"{self._name}: ended early: {acquisition.last_word()}")
                return
            if isinstance(event, HitJudged):
                self._told[event.hit.number] = event.hit
                self.tally.judged += 1
                self.tally.accepted += event.hit.verdict.accepted
            elif isinstance(event, SessionOpened):
                self._check_opened(event)
            elif isinstance(event, Prompted):
                if event.prompt.kind is PromptKind.HIT and kill_at_s == math.inf:
                    kill_at_s = now_s + float(self._rng.uniform(0.0, LONGEST_S))
                with suppress(OSError):
                    self._answer(channel, event)
            elif isinstance(event, Failed | Finished):
                was_meant = of_device and killed_s < math.inf and isinstance(event, Failed)
                if not (was_meant and event.kind == "DeviceLostError"):
                    self.tally.wrong.append(f"{self._name}: {event}")
                return

    @staticmethod
    def _answer(channel: object, event: Prompted) -> None:
        if event.prompt.kind is PromptKind.POSTURE:
            channel.send(StatedPosture())
        elif event.prompt.kind is PromptKind.POINT:
            channel.send(Ready())

    def _check_opened(self, event: SessionOpened) -> None:
        found = {hit.number for hit in read_journal(self._journal).hits[: event.hits_before]}
        if not set(self._told) <= found:
            self.tally.wrong.append(f"{self._name}: resumed without {set(self._told) - found}")

    def _compare(self) -> None:
        if not self._journal.exists():
            return
        try:
            found = rebuild(self._journal, self._journal.with_suffix(".h5"), software="test")
        except JournalError as error:
            if self._told:
                self.tally.wrong.append(f"{self._name}: not recovered: {error}")
            self._journal.unlink()  # killed before anything was recorded
            return
        wrong = missing(self._told, found.session)
        if wrong is not None:
            self.tally.wrong.append(f"{self._name}: {wrong}")
