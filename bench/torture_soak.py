"""Soak: full rate beside a redrawing screen and a busy core; samples in = samples accounted for.

A board streams 4 channels x 51.2 kS/s x 24 bit (0.61 MB/s on the wire) with a block of 2048 x 4
every two seconds. The acquisition is its own process; this one redraws a Textual screen of
160 x 45 characters 12 times a second from what it hears, and another process keeps a core busy.
Every sample the board took must have been seen, or be named as lost.

    python bench/torture_soak.py [seconds, default 600] [--directory FOLDER]

Exit code 1 if a single sample or block is not accounted for, or if it lasted less than wanted.
"""

from __future__ import annotations

import argparse
import asyncio
import dataclasses
import json
import multiprocessing
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from figures import Figure, told
from textual.app import App, ComposeResult
from textual.widgets import Static

from armodal.daq.commands import Ready, Stop
from armodal.daq.events import (
    Failed,
    Finished,
    HitJudged,
    LossNoted,
    Preview,
    Prompted,
    SessionOpened,
)
from armodal.daq.process import start_process
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.journal import load_journal

WIDTH, HEIGHT = 160, 45
REDRAWS_PER_S = 12.0
LONGEST_BEGIN_S = 300.0  # of processes that wait for a core


def busy() -> None:
    while True:
        pass


class Screen(App[None]):
    """Draws the envelope of every preview, and acts on the prompts."""

    def __init__(self, ours, seconds: float) -> None:
        super().__init__()
        self.ours = ours
        self.seconds = seconds
        self.begun_s, self.until_s = 0.0, float("inf")
        self.stopping = False
        self.finished: Finished | Failed | None = None
        self.hits: list[HitJudged] = []
        self.losses: list = []
        self.redraws = 0
        self.preview: Preview | None = None

    def compose(self) -> ComposeResult:
        yield Static()

    def on_mount(self) -> None:
        self.set_interval(1.0 / REDRAWS_PER_S, self.look)

    def look(self) -> None:
        if not self.stopping and time.monotonic() > self.until_s:
            self.ours.send(Stop(reason="the soak is over"))
            self.stopping = True
        while self.finished is None and self.ours.poll(0):
            self.hear(self.ours.recv())
        if self.preview is not None and self.finished is None:  # else the screen is going
            self.query_one(Static).update(picture(self.preview, self.redraws))
            self.redraws += 1

    def hear(self, event) -> None:
        if isinstance(event, Prompted) and event.prompt.kind is PromptKind.POINT:
            self.ours.send(Ready())
        elif isinstance(event, SessionOpened):
            self.begun_s = time.monotonic()
            self.until_s = self.begun_s + self.seconds
        elif isinstance(event, Preview):
            self.preview = event
        elif isinstance(event, HitJudged):
            self.hits.append(event)
        elif isinstance(event, LossNoted):
            self.losses.append(event.loss)
        elif isinstance(event, Finished | Failed):
            self.finished = event


def picture(preview: Preview, turn: int) -> str:
    """Columns of the envelope, a row a channel's part of the screen; no two are alike."""
    rows = []
    for row in range(HEIGHT):
        channel = row * preview.highest.shape[1] // HEIGHT
        spread = preview.highest[:, channel] - preview.lowest[:, channel]
        rows.append(
            "".join(" .:-=+*#%@"[(int(spread[x % len(spread)]) + x + row + turn) % 10]
                    for x in range(WIDTH))
        )  # fmt: skip
    return "\n".join(rows)


async def watch(screen: Screen, seconds: float) -> None:
    async with screen.run_test(size=(WIDTH, HEIGHT)):
        deadline_s = time.monotonic() + seconds + LONGEST_BEGIN_S
        while screen.finished is None and time.monotonic() < deadline_s:
            await asyncio.sleep(0.05)


def soak(seconds: float, folder: Path) -> dict[str, Any]:
    """Run and return what came of it; `unexplained` must be 0 and `failed` empty."""
    with subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("feeder.py"))],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as feeder:  # fmt: skip
        assert feeder.stdout is not None
        ports = json.loads(feeder.stdout.readline())
        arm = load_arm("rv4frl")
        plan = dataclasses.replace(load_plan("rv4frl-three-postures", arm), hits_per_point=1000)
        settings = AcquisitionSettings(
            board_port=ports["board"],
            can_channel=ports["can"],
            arm=arm,
            plan=plan,
            journal=folder / "soak.journal",
        )
        load = multiprocessing.get_context("spawn").Process(target=busy, daemon=True)
        load.start()
        running = start_process("acquire", settings)  # as the operator's app does
        screen = Screen(running.channel, seconds)
        started_s = time.monotonic()
        try:
            asyncio.run(watch(screen, seconds))
        finally:
            elapsed_s = time.monotonic() - (screen.begun_s or started_s)
            load.kill()
            if screen.finished is None:
                running.process.kill()
            running.process.wait()
            running.channel.close()
            running.stderr.close()
        sent = json.loads(feeder.communicate("stop\n", timeout=10)[0])
    finished = screen.finished
    if not isinstance(finished, Finished):
        return {"failed": finished.message if finished else "no end was announced"}
    kept = load_journal(settings.journal)
    lost = sum(loss.count for loss in kept.losses if loss.kind == "stream")
    produced = sent["stream_samples"] + sent["dropped_samples"]
    taken = finished.samples_taken if finished.samples_taken is not None else -1
    return {
        "failed": "",
        "seconds": round(elapsed_s, 1),
        "samples in": produced,
        "told by the board at the end": taken,
        "seen": finished.samples_seen,
        "reported missing": lost,
        "dropped by the board": sent["dropped_samples"],
        "of these since it was itself late": sent["dropped_late"],
        "unexplained": abs(sent["stream_samples"] - finished.samples_seen)
        + abs(sent["dropped_samples"] - lost)
        + abs(taken - produced),
        "blocks in": sent["blocks"],
        "hits": len(kept.hits),
        "hits announced": len(screen.hits),
        "accepted": sum(hit.verdict.accepted for hit in kept.hits),
        "redraws": screen.redraws,
        "cpu of acquisition, %": round(100.0 * finished.cpu_s / elapsed_s, 1),
        "previews replaced": finished.previews_dropped,
        "MB/s": round(sent["bytes"] / elapsed_s / 1e6, 2),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", type=float, nargs="?", default=600.0)
    parser.add_argument("--directory", type=Path, help="of the journal; a temporary one if not")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = soak(given.seconds, given.directory or Path(folder))
    for what, value in found.items():
        print(f"{what}: {value}")
    if found["failed"]:
        return told([Figure("soak", str(found["failed"]), "to its end", False)])
    seconds, unexplained = float(found["seconds"]), int(found["unexplained"])
    unannounced = abs(int(found["hits"]) - int(found["hits announced"]))
    taken, missing = int(found["samples in"]), int(found["reported missing"])
    late = int(found["of these since it was itself late"])
    return told(
        [
            Figure("soak at 4 x 51.2 kS/s, s", f"{seconds:.0f}", "600", seconds >= 600.0),
            Figure(
                f"... samples not accounted for, of {taken:,} taken, {missing:,} reported missing, "
                f"{late:,} of them since the simulated board was late",
                f"{unexplained:,}",
                "0",
                not unexplained,
            ),
            Figure(
                f"... hits kept and not announced, or not kept, of {found['hits']}",
                str(unannounced),
                "0",
                not unannounced,
            ),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
