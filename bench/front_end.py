"""A front end at 4 x 25.6 kS/s for some time: what is lost, and how soon a hit is judged.

    python bench/front_end.py SECONDS

A sound file with a hit every two seconds is replayed into the acquisition process; joint angles are
told by hand. What is measured: samples taken and seen, losses, verdict and commit times, processor
time of the acquisition process.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import wave
from pathlib import Path

import numpy as np

from armodal.daq.commands import Ready, Stop, ToldPosture
from armodal.daq.events import Failed, Finished, HitJudged, LossNoted, Prompted
from armodal.daq.process import start_process
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import plan_from_text

RATE_HZ, EVERY_S = 25_600, 2.0
PLAN = """
format = "armodal-plan-1"
name = "bench"
arm = "ur5"
mode = "roving-response"
fixed_point = "1"
hits_per_point = 100
max_attempts = 100
[sampling]
rate_hz = 25600
samples = 16384
pretrigger = 1000
[trigger]
level_n = 20.0
slope = "rising"
[windows]
exponential_end = 0.03
[sensor]
mass_kg = 0.0093
[[postures]]
name = "reach"
joints_deg = [15.0, -30.0, 40.0, -60.0, -70.0, 20.0]
tolerance_deg = 0.5
points = ["2", "3", "4", "5"]
hit_direction = [-0.45, -0.62, -0.64]
"""


def one_hit() -> np.ndarray:
    """Counts of two seconds: 200 N in 3 ms, and an answer at 30 Hz."""
    t = np.arange(int(EVERY_S * RATE_HZ)) / RATE_HZ - 0.5
    force = np.where((t >= 0) & (t < 3e-3), np.sin(np.pi * t / 3e-3), 0.0) * 2e6
    answer = np.where(t > 0, np.exp(-8.0 * t) * np.sin(2 * np.pi * 30.0 * t), 0.0) * 1e6
    noise = np.random.default_rng(1).normal(0.0, 100.0, (len(t), 4))
    return (np.stack([force, answer, 0.3 * answer, -answer], axis=1) + noise).astype("<i4")


def write(folder: Path, seconds: float) -> Path:
    three = one_hit().view(np.uint8).reshape(-1, 4, 4)[:, :, :3].tobytes()
    with wave.open(str(folder / "hits.wav"), "wb") as file:
        file.setparams((4, 3, RATE_HZ, 0, "NONE", "NONE"))
        for _ in range(int(seconds / EVERY_S) + 5):
            file.writeframes(three)
    channels = ["hammer", "acc_x", "acc_y", "acc_z"]
    text = 'format = "armodal-front-end-1"\ndevice = "replay"\nsource = "hits.wav"\n'
    for i, name in enumerate(channels, start=1):
        quantity = "force" if i == 1 else "acceleration"
        text += f'[[channels]]\nname = "{name}"\nquantity = "{quantity}"\ninput = {i}\n'
        text += f"full_scale = {838.86 if i == 1 else 83.886}\n"
    (folder / "bench.toml").write_text(text)
    return folder / "bench.toml"


def main(seconds: float) -> None:
    arm = load_arm("ur5")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        settings = AcquisitionSettings(
            board_port=str(write(folder, seconds)),
            told_tolerance_rad=math.radians(0.2),
            arm=arm,
            plan=plan_from_text(PLAN, arm),
            journal=folder / "s.journal",
        )
        acquisition = start_process("acquire", settings)
        hits: list[HitJudged] = []
        losses: list[str] = []
        while True:
            event = acquisition.channel.recv()
            if isinstance(event, Prompted) and event.prompt.kind is PromptKind.POSTURE:
                acquisition.channel.send(ToldPosture())
            elif isinstance(event, Prompted) and event.prompt.kind is PromptKind.POINT:
                acquisition.channel.send(Ready())
            elif isinstance(event, HitJudged):
                hits.append(event)
                if len(hits) * EVERY_S >= seconds:
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
                "hits": len(hits),
                "accepted": sum(hit.hit.verdict.accepted for hit in hits),
                "losses": losses,
                "samples_taken": event.samples_taken,
                "samples_seen": event.samples_seen,
                "verdict_s": {"median": verdicts[len(verdicts) // 2], "worst": verdicts[-1]},
                "commit_s_worst": max(hit.commit_s for hit in hits),
                "cpu_share": event.cpu_s / (event.samples_taken / RATE_HZ),
            },
            indent=1,
        )
    )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0)
