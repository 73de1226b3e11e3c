"""`armodal sim`: the command that it names goes with the laboratory that was started."""

import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.at_the_end import at_the_end
from support.command import armodal

from armodal.tui.commands import sim as sim_command

COMMAND = (sys.executable, "-m", "armodal.tui.cli", "sim", "--time-scale", "8")


def last_line(*options):
    lab = subprocess.Popen(
        [*COMMAND, *options], stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
    )
    with at_the_end(f"kill {lab.pid}"):
        line = next(line for line in lab.stderr if line.startswith("next:"))
        lab.terminate()
        lab.communicate()
    return line


@pytest.mark.long
def test_it_names_the_arm_and_the_plan_that_it_simulates():
    said = last_line("--arm", "ur5", "--plan", "ur5-five-postures")
    wanted = r"next: armodal run ur5-five-postures --arm ur5 --board \S+ --can \S+ --time-scale 8 "
    assert re.match(wanted, said)


@pytest.mark.long
def test_the_shipped_laboratory_goes_with_the_default_arm():
    assert re.match(r"next: armodal run PLAN --board \S+ --can \S+ --time-scale 8 ", last_line())


@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        ((), r"next: armodal run PLAN --board b --can c --time-scale 8 "),
        (
            ("--arm", "ur5", "--plan", "ur5-five-postures"),
            r"next: armodal run ur5-five-postures --arm ur5 --board b --can c --time-scale 8 ",
        ),
    ],
)
def test_it_names_what_goes_with_a_laboratory_that_is_there(options, wanted, monkeypatch):
    """Without its process."""
    begun = []

    @contextmanager
    def there(what, **settings):
        begun.append(what)
        yield SimpleNamespace(
            board="b",
            can="c",
            operator="o",
            ledger="l",
            time_scale=settings["time_scale"],
            truth_sha256="0" * 64,
            wait=lambda: None,
        )

    monkeypatch.setattr(sim_command, "start_laboratory", there)
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    said = armodal("sim", "--time-scale", "8", *options)
    assert said.returncode == 0
    assert re.match(wanted, " ".join(said.stderr.splitlines()[-1:]))
    assert len(begun) == 1
    if options:
        assert (begun[0].arm.name, begun[0].plan.name) == ("ur5", "ur5-five-postures")
    else:
        assert begun == ["rv4frl"]


def processes_with(*words):
    """Numbers of the processes with these in their command line; none of one that has ended."""
    found = []
    for told in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = told.read_bytes().decode(errors="replace")
            if all(word in line for word in words):
                found.append(int(told.parent.name))
        except OSError:  # it has gone meanwhile
            continue
    return found


def test_no_laboratory_outlives_a_command_that_is_ended_while_it_starts(tmp_path):
    folder = str(tmp_path / "lab")
    command = subprocess.Popen([*COMMAND, "--out", folder], stdin=subprocess.DEVNULL)
    with at_the_end(f"kill {command.pid}"):
        while not processes_with(
            folder, "armodal.hil_sim"
        ):  # a child of another name may come first
            assert command.poll() is None
            time.sleep(0.01)
        command.terminate()
        assert command.wait() == 128 + signal.SIGTERM
    assert processes_with(folder) == []
