"""The app beside the full stream of four channels, 51.2 kS/s, 24 bit: is a sample lost?

A feeder is board and controller; the app is opened in a real terminal and kept at the hit screen,
with its live views redrawn ten times a second and a hit every two seconds. Printed are what was
lost by the journal, the hits, how often the live view was drawn, and the app's share of a core.

    python bench/bench_run_stream.py [seconds]
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from bench_run_app import TICKS_HZ, cpu_s
from support.terminal import Terminal, armodal
from terminal_watch import TerminalWatch

from armodal.protocols.plan import PLANS_DIRECTORY
from armodal.protocols.session.journal import load_journal

LOOK_EVERY_S = 1.0


def stolen_s() -> float:
    """Seconds in which the machine's host gave the cores to others, over all cores."""
    return int(Path("/proc/stat").read_text(encoding="ascii").split()[8]) / TICKS_HZ


def main() -> int:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    feeder = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("feeder.py"))],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert feeder.stdout is not None
    ports = json.loads(feeder.stdout.readline())
    with tempfile.TemporaryDirectory() as folder:
        plan, journal = Path(folder) / "stream.toml", Path(folder) / "stream.journal"
        text = (PLANS_DIRECTORY / "rv4frl-three-postures.toml").read_text(encoding="utf-8")
        text = re.sub(r"hits_per_point = \d+", "hits_per_point = 100", text)
        plan.write_text(re.sub(r"max_attempts = \d+", "max_attempts = 1000", text))
        command = armodal("run", str(plan), "--session", str(journal))
        command += ["--board", ports["board"], "--can", ports["can"]]
        fifo = Path(folder) / "screen"
        os.mkfifo(fifo)
        told = TerminalWatch(fifo)
        with Terminal(command, columns=160, rows=45) as terminal:
            terminal.record_to(fifo)
            told.start()
            for words, key in (
                ("Are these sensors mounted", "Enter"),
                ("Enter: begin the session", "Enter"),
                ("Enter: yes, it is", "Enter"),
                ("Enter: mounted, ready to hit", "Enter"),
            ):
                terminal.until(words, 90.0)
                terminal.keys(key)
            terminal.until("hits at point", 30.0)
            pid = terminal.program_pid()
            begun_s, begun_cpu_s, stolen_begun_s, asked = (
                time.monotonic(),
                cpu_s(pid),
                stolen_s(),
                0,
            )
            while time.monotonic() - begun_s < seconds:
                time.sleep(LOOK_EVERY_S)
                shown = terminal.screen()
                told.look(shown)
                asked += "APPROACH?" in shown or "Enter: yes, it is" in shown
                if "Enter: " in shown:
                    terminal.keys("Enter")
            stolen = stolen_s() - stolen_begun_s
            share = (cpu_s(pid) - begun_cpu_s) / (time.monotonic() - begun_s)
            screen = terminal.screen()
            terminal.keys("q")
            terminal.until("ended", 600.0)  # all hits become a session file
        sent = json.loads(feeder.communicate("stop\n", timeout=20)[0])
        session = load_journal(journal)
        live_hz = told.live_view_hz()
        print(
            json.dumps(
                {
                    "seconds": seconds,
                    "sent": sent,
                    "losses": [f"{x.kind} {x.count}: {x.note}" for x in session.losses],
                    "losses_on_screen": re.findall(r"lost: (.*)", screen),
                    "hits": len(session.hits),
                    "accepted": len(session.accepted()),
                    "app_core_share_percent": round(100.0 * share, 1),
                    "live_view_hz": None if live_hz is None else round(live_hz, 1),
                    "approach_asked_again": asked,
                    "cores_stolen_by_the_host_s": round(stolen, 2),
                    "load_average": os.getloadavg(),
                },
                indent=2,
            )
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
