"""The demo's progress: one line on a terminal, one a posture elsewhere."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest
from support.terminal import ROOT, Terminal

SCRIPT = """
from dataclasses import replace
from support.made_run import judged
from armodal.daq.events import Finished
from armodal.tui.console import err
from armodal.tui.hit_count import HitCount
count = HitCount(err)
for number in range(1, 5):
    one = judged(number, *(["double"] if number == 2 else []))
    count(one if number < 4 else replace(one, hit=replace(one.hit, posture="test 2")))
count(Finished(complete=True, reason="done", journal="s", accepted=3, rejected=1, cpu_s=0.0,
               previews_dropped=0, samples_taken=None, samples_seen=0))
"""
COMMAND = [sys.executable, "-c", SCRIPT]
PATHS = {"PYTHONPATH": f"{ROOT}:{ROOT / 'tests'}"}


@pytest.mark.skipif(shutil.which("tmux") is None, reason="needs tmux")
def test_on_a_terminal_one_line_counts_the_hits():
    with Terminal(COMMAND, columns=80, rows=24, env=PATHS) as terminal:
        screen = terminal.until("ended 0", 60.0)
    lines = [line.rstrip() for line in screen.splitlines() if line.strip()]
    assert lines == ["· test 2: 3 hits accepted, 1 rejected so far", "ended 0"]


def test_elsewhere_every_posture_has_a_line():
    done = subprocess.run(COMMAND, env=PATHS, capture_output=True, text=True, check=True)
    assert done.stderr.splitlines() == [
        "· test 1: 2 hits accepted, 1 rejected so far",
        "· test 2: 3 hits accepted, 1 rejected so far",
    ]
