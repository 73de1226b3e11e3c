"""A front end at 4 x 25.6 kS/s for some time: what is lost, and how soon a hit is judged.

    python bench/front_end.py SECONDS [replay|sound|ni|opendaq]

A hit comes every two seconds; joint angles are told by hand. NI is a gRPC server of ours; openDAQ
its own server with signals of ours, by native streaming; the sound card one in the place of
PortAudio. What is measured: samples taken and seen, losses, verdict and commit times, how long the
machine held a process up, processor time of the acquisition process.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.held_up import StallWatch
from support.reach_plan import reach_plan
from support.source_devices import RATE_HZ, SOURCES

from armodal.daq.commands import Ready, StatedPosture, Stop
from armodal.daq.events import Failed, Finished, HitJudged, LossNoted, Prompted
from armodal.daq.process import start_process
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm

EVERY_S = 2.0
LATE_S = 0.15


def main(seconds: float, name: str) -> None:
    plan = reach_plan(rate_hz=RATE_HZ, samples=16384, pretrigger=1000)
    with tempfile.TemporaryDirectory() as made, ExitStack() as keep:
        folder = Path(made)
        text, device = SOURCES[name](folder, EVERY_S, seconds)
        if device is not None:
            keep.callback(device.kill)
        (folder / "bench.toml").write_text(text, encoding="utf-8")
        settings = AcquisitionSettings(
            board_port=str(folder / "bench.toml"),
            told_tolerance_rad=math.radians(0.2),
            arm=load_arm("ur5"),
            plan=plan,
            journal=folder / "s.journal",
        )
        held_up, began_s = StallWatch(), time.monotonic()
        acquisition = start_process("acquire", settings)
        hits: list[HitJudged] = []
        losses: list[str] = []
        while True:
            event = acquisition.channel.recv()
            ends = len(hits) * EVERY_S >= seconds  # then nothing is answered any more
            if isinstance(event, Prompted) and not ends:
                if event.prompt.kind is PromptKind.POSTURE:
                    acquisition.channel.send(StatedPosture())
                elif event.prompt.kind is PromptKind.POINT:
                    acquisition.channel.send(Ready())
            elif isinstance(event, HitJudged):
                hits.append(event)
                if len(hits) * EVERY_S >= seconds and not ends:
                    acquisition.channel.send(Stop())
            elif isinstance(event, LossNoted):
                losses.append(event.loss.note)
            elif isinstance(event, Failed):
                raise SystemExit(event.message)
            elif isinstance(event, Finished):
                break
    verdicts = sorted(hit.verdict_s for hit in hits)
    print(
        json.dumps(
            {
                "source": name,
                "hits": len(hits),
                "accepted": sum(hit.hit.verdict.accepted for hit in hits),
                "losses": losses,
                "samples_taken": event.samples_taken,
                "samples_seen": event.samples_seen,
                "verdict_s": {"median": verdicts[len(verdicts) // 2], "worst": verdicts[-1]},
                "verdicts_late": sum(verdict > LATE_S for verdict in verdicts),
                "machine_held_up_s": held_up.longest_s(began_s),
                "commit_s_worst": max(hit.commit_s for hit in hits),
                "cpu_share": event.cpu_s / (event.samples_taken / RATE_HZ),
            },
            indent=1,
        )
    )


if __name__ == "__main__":
    main(float((sys.argv[1:] or ["60"])[0]), (sys.argv[2:] or ["replay"])[0])
