"""A session of a whole day on a clock that passes as fast as samples are handed over.

A device samples noise from a prepared buffer, with a hit now and then. All that follows is the real
thing: the device library makes a board of it, its frames are cut, checked and counted, hits judged
and kept. Joint angles are told by hand.
"""

from __future__ import annotations

import gc
import hashlib
from collections import deque
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from support.fault_runs import shipped_arm
from support.virtual_operator import CHANNEL_FD

from armodal.daq.acquisition import run_acquisition
from armodal.daq.commands import Ready, StatedPosture, Stop
from armodal.daq.events import Failed, Finished, HitJudged, Preview, Prompted
from armodal.daq.front_end.board import FrontEndPort
from armodal.daq.front_end.source import Chunk
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.surroundings import Surroundings
from armodal.protocols.front_end import front_end_from_text
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal import read_journal

RATE_HZ = 25_600
SAMPLES, PRETRIGGER = 512, 128
HIT_EVERY_S = 120.0
MOST_HITS = 10_000  # of a point: the day ends before
FASTER = 20  # a turn of 12 ms is a quarter of a second of the laboratory
LOOK_AT = 0.1  # of the day: when all that is made once has been made
NOISE_COUNTS = 3000
AT_ONCE = 64  # samples that the device hands over, as many as a frame of the preview holds
BUFFER = 1 << 16  # samples of the prepared noise

FRONT_END = """
format = "armodal-front-end-1"
device = "sound"
[[channels]]
name = "hammer"
quantity = "force"
input = 1
full_scale = 800.0
[[channels]]
name = "acc_x"
quantity = "acceleration"
input = 2
full_scale = 80.0
[[channels]]
name = "acc_y"
quantity = "acceleration"
input = 3
full_scale = 80.0
[[channels]]
name = "acc_z"
quantity = "acceleration"
input = 4
full_scale = 80.0
"""
PLAN = f"""
format = "armodal-plan-1"
name = "a-day"
arm = "rv4frl"
mode = "roving-response"
fixed_point = "1"
hits_per_point = 100
max_attempts = 100
[sampling]
rate_hz = {RATE_HZ}.0
samples = {SAMPLES}
pretrigger = {PRETRIGGER}
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
tolerance_deg = 1.0
points = ["2", "3"]
hit_direction = [0.0, -1.0, 0.0]
"""


def resident_bytes() -> int:
    """Memory that this process holds."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return 1024 * int(line.split()[1])
    raise LookupError("VmRSS")


def digest(counts: np.ndarray[Any, Any]) -> bytes:
    """What samples are known by, so that they need not be kept."""
    return hashlib.sha256(counts.tobytes()).digest()


class FastClock:
    """Lab seconds that pass when somebody waits; the board's line can always be read."""

    def __init__(self, channel: _Channel) -> None:
        self._channel = channel
        self._now_s = 1000.0

    def now_s(self) -> float:
        return self._now_s

    def sleep(self, lab_s: float) -> None:
        self._now_s += max(lab_s, 0.0)

    def wall_s(self, lab_s: float) -> float:
        return lab_s / FASTER

    def wait(self, descriptors: Any, _wall_s: float) -> list[int]:
        self._now_s += 1e-4  # whoever asks in a circle gets on
        return [fd for fd in descriptors if fd != CHANNEL_FD or self._channel.poll(0)]


class _Channel:
    """What the operator has said."""

    def __init__(self) -> None:
        self.said: deque[Any] = deque()

    def fileno(self) -> int:
        return CHANNEL_FD

    def poll(self, _timeout_s: float) -> bool:
        return bool(self.said)

    def recv(self) -> Any:
        return self.said.popleft()


class Device:
    """A `SampleSource`: noise of a buffer, and a pulse with its answer wherever a hit is due."""

    driver = "prepared noise"
    teds: tuple[bytes, ...] = ()

    def __init__(self) -> None:
        rng = np.random.default_rng(1)
        noise = rng.integers(-NOISE_COUNTS, NOISE_COUNTS, (BUFFER, 4)).astype(np.int32)
        noise[:, 0] //= 100  # of a hammer at rest
        self._noise = np.concatenate([noise, noise])
        t = np.arange(SAMPLES) / RATE_HZ
        pulse = np.where(t < 3e-3, 2e6 * np.sin(np.pi * t / 3e-3), 0.0)
        answer = 5e5 * np.exp(-300.0 * t) * np.sin(900.0 * t)
        self._blow = np.stack([pulse, answer, answer, answer], axis=1).astype(np.int32)
        self._begun_s = 0.0
        self.taken = 0

    def rate_refusal(self, rate_hz: Fraction) -> str:
        return "" if rate_hz == RATE_HZ else "another rate"

    def start(self, rate_hz: Fraction, now_s: float) -> None:
        del rate_hz
        self._begun_s, self.taken = now_s, 0

    def stop(self) -> None:
        """Nothing goes on by itself."""

    def close(self) -> None:
        """Nothing is held."""

    def counts(self, first: int, n: int) -> np.ndarray[Any, Any]:
        """Return what was sampled from `first` on, (n, 4)."""
        if n > BUFFER:
            parts = [self.counts(at, min(BUFFER, first + n - at))
                     for at in range(first, first + n, BUFFER)]  # fmt: skip
            return np.concatenate(parts)
        at = first % BUFFER
        found = self._noise[at : at + n]
        every = round(HIT_EVERY_S * RATE_HZ)
        begin = max((first + n - 1) // every, 1) * every  # the last hit that may reach in here
        low, high = max(begin, first), min(begin + SAMPLES, first + n)
        if low < high:
            found = found.copy()
            found[low - first : high - first] += self._blow[low - begin : high - begin]
        return found

    def read(self, now_s: float) -> list[Chunk]:
        due = int((now_s - self._begun_s) * RATE_HZ) // AT_ONCE * AT_ONCE
        first, self.taken = self.taken, max(due, self.taken)
        if first == self.taken:
            return []
        counts = self.counts(first, self.taken - first)
        return [Chunk(counts=counts, ready_s=self._begun_s + first / RATE_HZ)]


@dataclass
class _Operator:
    """Does what is asked; an outbox on its other side."""

    channel: _Channel
    clock: FastClock
    seconds: float
    previews_dropped: int = 0
    announced: dict[int, bytes] = field(default_factory=dict)
    previews: int = 0
    begun_s: float = 0.0
    memory: list[tuple[float, int]] = field(default_factory=list)
    ending: Finished | Failed | None = None

    def put(self, event: Any) -> None:
        if isinstance(event, Prompted):
            if event.prompt.kind is PromptKind.POSTURE:
                self.channel.said.append(StatedPosture())
            elif event.prompt.kind is PromptKind.POINT:
                self.channel.said.append(Ready())
        elif isinstance(event, HitJudged):
            if event.hit.verdict.accepted:
                self.announced[event.hit.number] = digest(event.hit.counts)
        elif isinstance(event, Preview):
            self._look()
        elif isinstance(event, Failed | Finished):
            self.ending = event

    def finish(self, _timeout_s: float) -> bool:
        return True

    def _look(self) -> None:
        self.previews += 1
        now_s = self.clock.now_s()
        self.begun_s = self.begun_s or now_s
        passed = (now_s - self.begun_s) / self.seconds
        if passed >= LOOK_AT * (len(self.memory) + 1):
            gc.collect()
            self.memory.append((passed, resident_bytes()))
        if passed >= 1.0:
            self.channel.said.append(Stop(reason="the day is over"))


@dataclass(frozen=True)
class Day:
    """What became of it; `memory` after every tenth of it, in bytes."""

    failed: str
    taken: int
    seen: int
    missing: int
    kept: int
    announced: int
    lost: list[int]
    altered: list[int]
    memory: list[int]
    journal_bytes: int
    previews: int

    @property
    def unexplained(self) -> int:
        """Samples that are neither seen nor reported missing."""
        return abs(self.taken - self.seen - self.missing)

    @property
    def grown(self) -> int:
        """Bytes that the process held more at the end than after the first tenth."""
        return self.memory[-1] - self.memory[0] if len(self.memory) > 1 else 0


def run_day(folder: Path, seconds: float) -> Day:
    """Sample for so many seconds of the laboratory; return what became of it."""
    arm, channel = shipped_arm(), _Channel()
    clock, device = FastClock(channel), Device()
    operator = _Operator(channel=channel, clock=clock, seconds=seconds)
    front_end = front_end_from_text(FRONT_END, name="prepared", origin="front end")
    journal = folder / "day.journal"
    plan = replace(plan_from_text(PLAN, arm), hits_per_point=MOST_HITS)
    settings = AcquisitionSettings(
        board_port="prepared", arm=arm, plan=plan, journal=journal,
        told_tolerance_rad=float(np.radians(0.2)), session_id="d" * 16,
    )  # fmt: skip
    surroundings = Surroundings(
        clock=clock,
        open_board=lambda _settings: FrontEndPort(front_end, device, clock),
        open_can=lambda _settings, _bitrate: None,  # type: ignore[arg-type,return-value]
        make_outbox=lambda _channel: operator,
    )
    run_acquisition(settings, channel, surroundings)  # type: ignore[arg-type]
    ending = operator.ending
    if not isinstance(ending, Finished):
        said = "no end was announced" if ending is None else ending.message
        return Day(said, device.taken, 0, 0, 0, 0, [], [], [], 0, 0)
    found = read_journal(journal)
    kept = {hit.number: hit for hit in found.hits if hit.verdict.accepted}
    return Day(
        failed="",
        taken=device.taken,
        seen=ending.samples_seen,
        missing=sum(loss.count for loss in found.losses if loss.kind == "stream"),
        kept=len(kept),
        announced=len(operator.announced),
        lost=[n for n, counts in operator.announced.items()
              if n not in kept or digest(kept[n].counts) != counts],
        altered=[n for n, hit in kept.items()
                 if not np.array_equal(device.counts(hit.first_sample, SAMPLES), hit.counts)],
        memory=[size for _, size in operator.memory],
        journal_bytes=journal.stat().st_size,
        previews=operator.previews,
    )  # fmt: skip
