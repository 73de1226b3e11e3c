"""Acquisition at the full stream of four channels, 51.2 kS/s, 24 bit, beside a busy core.

Prints what was sent and received, the process's share of a core, and for every hit how long
verdict and commit took. Targets: below 5 % of a core, nothing lost, verdict within 100 ms of the
last sample, commit at most 5 ms in the median.

    python bench/bench_acquisition.py [seconds] [--quiet]

With --quiet no core is kept busy.
"""

from __future__ import annotations

import dataclasses
import json
import multiprocessing
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from armodal.daq.acquisition import run_acquisition
from armodal.daq.commands import Ready, Stop
from armodal.daq.events import Failed, Finished, HitJudged, LossNoted, Prompted
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan


def busy() -> None:
    while True:
        pass


def listen(ours, seconds: float) -> tuple[list, list, object]:
    hits, losses, finished = [], [], None
    until = time.monotonic() + seconds
    stopped = False
    while finished is None:
        if not stopped and time.monotonic() > until:
            ours.send(Stop(reason="bench is over"))
            stopped = True
        if not ours.poll(0.2):
            continue
        event = ours.recv()
        if isinstance(event, Prompted) and event.prompt.kind is PromptKind.POINT:
            ours.send(Ready())
        elif isinstance(event, HitJudged):
            hits.append(event)
        elif isinstance(event, LossNoted):
            losses.append(event.loss)
        elif isinstance(event, Finished | Failed):
            finished = event
    return hits, losses, finished


def main() -> int:
    arguments = [a for a in sys.argv[1:] if a != "--quiet"]
    seconds = float(arguments[0]) if arguments else 60.0
    feeder = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("feeder.py"))],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert feeder.stdout is not None
    ports = json.loads(feeder.stdout.readline())
    arm = load_arm("rv4frl")
    plan = load_plan("rv4frl-three-postures", arm)
    load = multiprocessing.Process(target=busy, daemon=True)
    if "--quiet" not in sys.argv:
        load.start()
    with tempfile.TemporaryDirectory() as folder:
        settings = AcquisitionSettings(
            board_port=ports["board"],
            can_channel=ports["can"],
            arm=arm,
            plan=dataclasses.replace(plan, hits_per_point=1000),
            journal=Path(folder) / "bench.journal",
        )
        ours, theirs = multiprocessing.Pipe()
        process = multiprocessing.get_context("spawn").Process(
            target=run_acquisition, args=(settings, theirs)
        )
        process.start()
        begun = time.monotonic()
        hits, losses, finished = listen(ours, seconds)
        elapsed = time.monotonic() - begun
        process.join()
    sent = json.loads(feeder.communicate("stop\n", timeout=10)[0])
    if load.pid is not None:
        load.kill()
    if isinstance(finished, Failed):
        print(finished.message)
        return 1
    print(f"finished: {finished}")
    print(f"sent: {sent}, {sent['bytes'] / elapsed / 1e6:.2f} MB/s")
    print(f"losses: {losses or 'none'}")
    print(f"CPU of the loop: {100 * finished.cpu_s / elapsed:.1f} % of a core over {elapsed:.0f} s")
    verdicts = [1e3 * hit.verdict_s for hit in hits]
    commits = [1e3 * hit.commit_s for hit in hits]
    accepted = sum(hit.hit.verdict.accepted for hit in hits)
    print(f"hits: {len(hits)}, accepted {accepted}")
    print(f"verdict: median {statistics.median(verdicts):.1f} ms, worst {max(verdicts):.1f} ms")
    print(f"commit: median {statistics.median(commits):.2f} ms, worst {max(commits):.2f} ms")
    print(f"clock: {1e6 * hits[-1].clock_uncertainty_s:.0f} us standard uncertainty")
    return 0


if __name__ == "__main__":
    sys.exit(main())
