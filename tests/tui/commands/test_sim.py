"""`armodal sim`: the command that it names goes with the laboratory that was started."""

import re
import subprocess
import sys

from support.at_the_end import at_the_end

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


def test_it_names_the_arm_and_the_plan_that_it_simulates():
    said = last_line("--arm", "ur5", "--plan", "ur5-five-postures")
    wanted = r"next: armodal run ur5-five-postures --arm ur5 --board \S+ --can \S+ --time-scale 8 "
    assert re.match(wanted, said)


def test_the_shipped_laboratory_goes_with_the_default_arm():
    assert re.match(r"next: armodal run PLAN --board \S+ --can \S+ --time-scale 8 ", last_line())
