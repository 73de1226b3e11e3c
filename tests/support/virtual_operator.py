"""The operator of a laboratory on a virtual clock: goes, mounts and hits as prompted, patiently."""

from collections import deque

from support.known_arm import KnownBlow

from armodal.daq.commands import Ready, Stop
from armodal.daq.events import Failed, Finished, HitJudged, Noted, Prompted
from armodal.daq.session_machine import PromptKind

CHANNEL_FD = 1003  # of the operator's channel among the descriptors that are waited for
PATIENCE_S = 4.0  # until a hit nobody speaks of is repeated
LONGEST_S = 90.0  # of one acquisition, until the operator gives up


class Channel:
    """The operator's commands on their way."""

    def __init__(self):
        self.said = deque()

    def fileno(self):
        return CHANNEL_FD

    def poll(self, _timeout_s):
        return bool(self.said)

    def recv(self):
        return self.said.popleft()


class VirtualOperator:
    """Does what is asked; an outbox on its other side."""

    previews_dropped = 0

    def __init__(self, lab):
        self._lab = lab
        self.events = []
        self.begun_s = lab.wall_s
        self._due = None  # (lab time, what to do)

    def begin(self):
        self.begun_s = self._lab.wall_s
        self._due = None

    def put(self, event):
        if isinstance(event, Prompted | HitJudged | Failed | Finished | Noted):
            self.events.append((self._lab.wall_s, event))
        if isinstance(event, Prompted):
            self._answer(event.prompt)
        elif isinstance(event, Failed | Finished):
            self._due = None

    def finish(self, _timeout_s):
        return True

    def step(self):
        now_s = self._lab.wall_s
        if now_s > self.begun_s + LONGEST_S:
            self.begun_s, self._due = now_s, None
            self._lab.channel.said.append(Stop(reason="the operator gives up"))
        if self._due is not None and now_s >= self._due[0]:
            _, do = self._due
            self._due = None
            do()

    def _after(self, seconds, do):
        self._due = (self._lab.wall_s + seconds * self._lab.rng.uniform(0.9, 1.1), do)

    def _answer(self, prompt):
        if prompt.kind is PromptKind.POSTURE:
            self._after(0.3, lambda: self._go(prompt))
        elif prompt.kind is PromptKind.POINT:
            self._after(0.3, lambda: self._mount(prompt))
        elif prompt.kind is PromptKind.HIT:
            self._after(0.35, lambda: self._hit(prompt))
        else:
            self._due = None

    def _go(self, prompt):
        self._lab.controller.move_to(prompt.posture.joints_rad)
        self._after(PATIENCE_S, lambda: self._go(prompt))

    def _mount(self, prompt):
        self._lab.cell.mount(prompt.sensor_point)
        self._lab.ledger.note("mount", self._lab.wall_s, point=prompt.sensor_point)
        self._lab.channel.said.append(Ready())
        self._after(PATIENCE_S, lambda: self._mount(prompt))

    def _hit(self, prompt):
        lab = self._lab
        blow = KnownBlow(peak_counts=int(lab.rng.integers(60_000, 150_000)))
        at_sample = lab.cell.strike(lab.rng.uniform(1.0, 2.0), blow)
        if at_sample is not None:
            lab.n_blows += 1
            for number, fault, after, n in lab.at_blows:
                if number == lab.n_blows:
                    at = max(int(at_sample) + after, 0)
                    lab.faults.switch(f"{fault}@{at}" + (f"+{n}" if n else ""), active=True)
            facts = {
                "at_sample": at_sample,
                "point": prompt.hit_point,
                "sensor_point": lab.cell.point,
                "peak_counts": blow.peak_counts,
            }
            lab.epochs[-1].blows.append(facts)
            lab.ledger.note("hit", lab.wall_s, epoch=len(lab.epochs), **facts)
        self._after(PATIENCE_S, lambda: self._hit(prompt))
