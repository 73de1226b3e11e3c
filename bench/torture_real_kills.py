"""Kill acquisition processes, recover, resume, and again.

The laboratory is simulated, the acquisition a process of its own, as in a real session. SIGKILL
comes by `strace` injection at the n-th write, sync or cut of the journal; in every third process,
where that does not come about, and where there is no strace, after a seeded time. What the process
had told of is then compared with what is recovered; one journal is resumed many times before the
next is begun, sometimes with half a record behind its end.

    python bench/torture_real_kills.py [seed] [kills]
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass, field
from multiprocessing.connection import Listener
from pathlib import Path

import numpy as np
from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.accepted_hits import missing
from support.simulated_session import PLAN, operate

from armodal.daq.events import Event, Failed, HitJudged, SessionOpened
from armodal.hil_sim.lab import Laboratory, start_laboratory
from armodal.hil_sim.ledger import read_ledger
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import JournalError
from armodal.protocols.plan import load_plan
from armodal.protocols.session.journal import encode_hit, read_journal
from armodal.protocols.session.recovery import rebuild
from armodal.tui.operators import ScriptedOperator

TIME_SCALE = 16.0
KILLS = 100
KILLS_OF_A_JOURNAL = 12
CALLS = {"write": 8, "fdatasync": 8, "ftruncate": 1}  # and the latest of them to be hit
LONGEST_S = 2.0  # behind the process's first word, as a rule
LONGEST_INJECTED_S = 6.0
HALF = 5000  # bytes of a torn record
STRACE = shutil.which("strace")
SCRIPT = Path(__file__).with_name("acquisition_process.py")


@dataclass
class Tally:
    by_strace: int = 0
    by_time: int = 0
    ended: int = 0
    hits: int = 0
    dropped: int = 0
    commands: int = 0
    wrong: list[str] = field(default_factory=list)

    @property
    def kills(self) -> int:
        return self.by_strace + self.by_time


class Killing:
    """One process, and the way it is to be killed."""

    def __init__(
        self, laboratory: Laboratory, folder: Path, journal: Path, rng: np.random.Generator
    ) -> None:
        self.injected = STRACE is not None and rng.random() < 2 / 3
        self.after_s = LONGEST_INJECTED_S if self.injected else float(rng.uniform(0.0, LONGEST_S))
        self.timed_out = False
        command = [sys.executable, str(SCRIPT), str(folder / "ear"), laboratory.board]
        command += [laboratory.can, str(journal), str(folder / "plan.toml"), str(TIME_SCALE)]
        if self.injected:
            call = str(rng.choice(list(CALLS), p=(0.45, 0.45, 0.1)))
            when = int(rng.integers(1, CALLS[call] + 1))
            inject = f"inject={call}:signal=KILL:when={when}"
            trace = [str(STRACE), "-f", "-qq", "-o", "/dev/null", "-P", str(journal)]
            command = [*trace, "-e", f"trace={','.join(CALLS)}", "-e", inject, *command]
        with Listener(str(folder / "ear"), "AF_UNIX") as listener:
            self.process = subprocess.Popen(command)
            self.channel = listener.accept()
        self.pid = self.channel.recv()

    def run(self, operator: ScriptedOperator) -> list[Event]:
        """Let the session run until it is killed or ends; return all that it told."""
        heard: list[Event] = []
        clock = threading.Timer(self.after_s, self._kill)
        clock.start()
        operate(self.channel, operator, heard=heard.append)
        clock.cancel()
        self.channel.close()
        self.process.wait()
        return heard

    def _kill(self) -> None:
        self.timed_out = True
        os.kill(self.pid, signal.SIGKILL)


def checked(journal: Path, told_of: dict, tally: Tally) -> None:
    """Recover in this process, and compare."""
    try:
        found = rebuild(journal, journal.with_suffix(".h5"), software="torture")
    except JournalError as error:
        if told_of:
            tally.wrong.append(f"not recovered: {error}")
        return
    wrong = missing(told_of, found.session)
    if wrong is not None:
        tally.wrong.append(wrong)
    tally.dropped += found.dropped_bytes > 0


def checked_by_command(journal: Path, told_of: dict, tally: Tally) -> None:
    """Recover by the command that a user types."""
    command = [sys.executable, "-m", "armodal.tui.cli", "recover", str(journal), "--json"]
    said = subprocess.run(command, capture_output=True, text=True, check=False)
    tally.commands += 1
    if said.returncode != 0 or json.loads(said.stdout)["hits"]["accepted"] < len(told_of):
        tally.wrong.append(f"armodal recover: {said.stdout} {said.stderr}")


def one_journal(
    laboratory: Laboratory, folder: Path, kills: int, rng: np.random.Generator, tally: Tally
) -> None:
    """Kill the sessions of one journal so many times."""
    arm = load_arm("rv4frl")
    plan = load_plan(str(folder / "plan.toml"), arm)
    operator = ScriptedOperator(laboratory.operator, arm, plan, time_scale=TIME_SCALE)
    journal = folder / "session.journal"
    for path in folder.glob("*session*"):
        path.unlink()
    told_of: dict = {}
    for _ in range(kills):
        if journal.exists() and not told_of:
            journal.unlink()  # it may have been killed before anything was recorded
        if told_of and rng.random() < 1 / 4:
            with journal.open("ab") as file:
                file.write(encode_hit(read_journal(journal).hits[-1])[:HALF])
            checked(journal, told_of, tally)
        killing = Killing(laboratory, folder, journal, rng)
        heard = killing.run(operator)
        for event in heard:
            if isinstance(event, HitJudged) and event.hit.verdict.accepted:
                told_of[event.hit.number] = event.hit
            elif isinstance(event, SessionOpened):
                found = read_journal(journal).hits[: event.hits_before]
                told_of |= {hit.number: hit for hit in found if hit.verdict.accepted}
        if killing.process.returncode >= 0 and killing.process.returncode != 137:
            tally.ended += 1
            tally.wrong += [e.message for e in heard if isinstance(e, Failed)]
        elif not killing.timed_out:
            tally.by_strace += 1
        else:
            tally.by_time += 1
        if journal.exists():
            checked(journal, told_of, tally)
    tally.hits += len(told_of)
    if told_of:
        checked_by_command(journal, told_of, tally)
    operator.close()


def main() -> int:
    numbers = [int(argument) for argument in sys.argv[1:]]
    seed, kills = (*numbers, *(1, KILLS)[len(numbers) :])
    rng = np.random.default_rng(seed)
    tally = Tally()
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home)
        points = '["2", "5", "8", "11"]'
        plan = PLAN.format(hits=100, samples=2048, points=points)
        (folder / "plan.toml").write_text(plan, encoding="utf-8")
        with start_laboratory(
            "rv4frl", seed=seed, time_scale=TIME_SCALE, directory=folder / "lab"
        ) as laboratory:
            while tally.kills < kills and not tally.wrong:
                more = min(KILLS_OF_A_JOURNAL, kills - tally.kills)
                one_journal(laboratory, folder, more, rng, tally)
                print(tally, flush=True)
        (end,) = read_ledger(folder / "lab" / "ledger.jsonl").of("end")
    print(*tally.wrong, sep="\n")
    return told(
        [
            Figure(
                "processes killed (SIGKILL)",
                f"{tally.kills}: {tally.by_strace} by strace, {tally.by_time} by time",
                str(kills),
                tally.kills >= kills,
            ),
            Figure("accepted hits told of", str(tally.hits), "1", tally.hits > 0),
            Figure(
                "... lost or altered, or not resumed",
                str(len(tally.wrong)),
                "0",
                not tally.wrong,
            ),
            Figure(
                "requests to transmit that the CAN adapter got meanwhile",
                str(end["can_transmissions"]),
                "0",
                end["can_transmissions"] == 0,
            ),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
