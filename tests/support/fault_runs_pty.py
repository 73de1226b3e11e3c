"""Faulty sessions on real pseudo-terminals: the laboratory as a process, at 16 times the clock."""

import json
import multiprocessing
import socket
import sys
import tempfile
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from support.fault_runs import PLAN
from support.known_laboratory import HEAD
from support.virtual_lab import Epoch

from armodal.daq.acquisition import run_acquisition
from armodal.daq.commands import Ready, Stop
from armodal.daq.events import Failed, Finished, HitJudged, Prompted
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.hil_sim.lab import launch
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal import read_journal

TIME_SCALE = 16.0
LONGEST_WALL_S = 25.0  # of one acquisition; undisturbed it takes two
# The arm is at rest at first, so that sessions begin at about the same sample.
PTY_MATRIX = (
    (),
    ("bit-flip@2000+4000",),
    ("frame-drop@2000+4000",),
    ("frame-duplicate@2000+4000",),
    ("frame-reorder@2000+4000",),
    ("frame-truncate@2000+4000",),
    ("link-stall@3000+900",),
    ("device-overflow@3000+2000",),
    ("board-reboot@6000",),
    ("clock-jump@5000",),
    ("clock-drift@3000+9000",),
    ("channel-stuck@4000+6000",),
    ("channel-garbage@4000+6000",),
    ("adc-gap@5000", "frame-drop@5000+3000"),
    ("can-silence@5000+3000",),
    ("can-corrupt@3000+9000", "bit-flip@4000+4000"),
)
KNOWN_POSTURE_DEG = [0.0] * 6


class OperatorByScript:
    """Answers prompts over the laboratory's socket, one after the other, in a thread."""

    def __init__(self, path):
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(60.0)
        self._socket.connect(str(path))
        self._file = self._socket.makefile("rb")
        self.send = lambda command: None
        self._wanted = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def asked(self, prompt):
        with self._changed:
            self._wanted = prompt
            self._changed.notify()

    def close(self):
        with self._changed:
            self._wanted = "end"
            self._changed.notify()
        self._thread.join(10.0)
        self._file.close()
        self._socket.close()

    def _serve(self):
        while True:
            with self._changed:
                while self._wanted is None:
                    self._changed.wait()
                prompt, self._wanted = self._wanted, None
            if prompt == "end":
                return
            self._act(prompt)
            # What was hit, and never heard of, is hit again.
            with self._changed:
                again = prompt.kind is PromptKind.HIT and not self._changed.wait_for(
                    lambda: self._wanted is not None, 0.5
                )
                if again:
                    self._wanted = prompt

    def _act(self, prompt):
        if prompt.kind is PromptKind.POSTURE:
            joints_deg = np.degrees(prompt.posture.joints_rad).tolist()
            self._ask(do="posture", name=prompt.posture.name, joints_deg=joints_deg)
        elif prompt.kind is PromptKind.POINT:
            self._ask(do="mount", point=prompt.sensor_point)
            self.send(Ready())
        elif prompt.kind is PromptKind.HIT:
            self._ask(do="hit", point=prompt.hit_point, direction=[0.0, -1.0, 0.0])

    def _ask(self, **request):
        self._socket.sendall(json.dumps(request).encode() + b"\n")
        return json.loads(self._file.readline())


def run_on_ptys(number, faults=None):
    """Run session `number` of the matrix; return the violations and what it was and became."""
    faults = PTY_MATRIX[number % len(PTY_MATRIX)] if faults is None else faults
    arm = load_arm("rv4frl")
    text = PLAN.replace("[-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]", str(KNOWN_POSTURE_DEG))
    plan = plan_from_text(text, arm)
    with tempfile.TemporaryDirectory() as folder:
        script = Path(__file__).with_name("known_laboratory.py")
        command = [sys.executable, str(script), "--time-scale", str(TIME_SCALE)]
        command += ["--seed", str(number), "--directory", f"{folder}/lab", "--watch-stdin"]
        for fault in faults:
            command += ["--fault", fault]
        with launch(command) as laboratory:
            settings = AcquisitionSettings(
                board_port=str(laboratory.board),
                can_channel=str(laboratory.can),
                arm=arm,
                plan=plan,
                journal=Path(folder) / "session.journal",
                time_scale=TIME_SCALE,
            )
            violations, announced, endings = [], [], []
            operator = OperatorByScript(laboratory.operator)
            for _ in range(3):
                resumed = replace(settings, resume=settings.journal.exists())
                ending = _acquire(resumed, operator, announced)
                endings.append(ending)
                if ending is None:
                    violations.append("it did not end")
                    break
                if isinstance(ending, Finished):
                    break
            operator.close()
        epochs = _epochs(Path(folder) / "lab")
        journal = read_journal(settings.journal)
        violations += _held_against(journal, announced, epochs)
        last = endings[-1]
        words = getattr(last, "reason", None) or getattr(last, "message", "nothing")
        accepted = sum(hit.verdict.accepted for hit in journal.hits)
        return violations, (
            f"{' and '.join(faults) or 'no fault'}: {len(journal.hits)} hits, {accepted} accepted, "
            f"{len(endings)} acquisitions, {words[:70]}"
        )


def _acquire(settings, operator, announced):
    ours, theirs = multiprocessing.Pipe()
    thread = threading.Thread(target=run_acquisition, args=(settings, theirs), daemon=True)
    thread.start()
    operator.send = ours.send
    begun_s, stopped, ending = time.monotonic(), False, None
    try:
        while ending is None and time.monotonic() < begun_s + 2.0 * LONGEST_WALL_S:
            if not stopped and time.monotonic() > begun_s + LONGEST_WALL_S:
                ours.send(Stop(reason="the operator gives up"))
                stopped = True
            if not ours.poll(0.1):
                continue
            event = ours.recv()
            if isinstance(event, Prompted):
                operator.asked(event.prompt)
            elif isinstance(event, HitJudged):
                announced.append(event.hit)
            elif isinstance(event, Failed | Finished):
                ending = event
    finally:
        thread.join(10.0)
        ours.close()
        theirs.close()
    return ending


def _epochs(folder):
    epochs = []
    for path in sorted(folder.glob("samples-*.bin"), key=lambda p: int(p.stem[8:])):
        data, at, epoch = path.read_bytes(), 0, Epoch(rate_hz=51200 / 31)
        while at < len(data):
            first, n = HEAD.unpack_from(data, at)
            at += HEAD.size
            counts = np.frombuffer(data, np.int32, 4 * n, at).reshape(n, 4)
            epoch.chunks.append((first, counts, 0.0))
            at += counts.nbytes
        epochs.append(epoch)
    return epochs


def _held_against(journal, announced, epochs):
    violations: list[str] = []
    kept = {hit.number: hit for hit in journal.hits}
    violations += [
        f"hit {hit.number} was announced otherwise than it is kept"
        for hit in announced
        if not np.array_equal(kept[hit.number].counts, hit.counts)
    ]
    for hit in journal.hits:
        n = len(hit.counts)
        if n and not any(
            np.array_equal(epoch.counts(hit.first_sample, n), hit.counts) for epoch in epochs
        ):
            violations.append(f"hit {hit.number}: {n} samples were never taken so")
        if hit.verdict.accepted and n != journal.header.plan.sampling.samples:
            violations.append(f"accepted hit {hit.number} has {n} samples")
    short = sum(256 - len(hit.counts) for hit in journal.hits)
    told = sum(loss.count for loss in journal.losses if loss.kind == "block")
    if told < short:
        violations.append(f"{short} samples of blocks are missing, {told} reported")
    return violations
