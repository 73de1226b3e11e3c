"""Processes that work runs on: Ctrl-C at the terminal goes to all, and one speaks."""

import signal
import subprocess
import sys
from multiprocessing import active_children
from pathlib import Path

import pytest

from armodal.tui.command_parts.worker_processes import worker_processes

PROGRAM = """
import os, signal, time
from armodal.tui.command_parts.worker_processes import worker_processes

if __name__ == "__main__":
    # Whoever runs the tests in the background has Ctrl-C ignored, and processes inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with worker_processes(2) as executor:
        {first}
        long = executor.submit(time.sleep, 3600.0)
        os.killpg(0, signal.SIGINT)
        long.result()
"""


@pytest.mark.parametrize("first", ["pass", "executor.submit(int).result()"])
def test_ctrl_c_ends_processes_that_start_or_work_and_only_the_first_one_speaks(tmp_path, first):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.format(first=first))
    ended = subprocess.run(
        [sys.executable, program],
        cwd=Path(__file__).parents[3],
        env={"PYTHONPATH": str(Path(__file__).parents[3])},
        capture_output=True,
        text=True,
        start_new_session=True,
        timeout=300.0,
        check=False,
    )
    assert ended.returncode == -signal.SIGINT
    assert ended.stderr.count("Traceback") == 1
    assert "KeyboardInterrupt" in ended.stderr.splitlines()[-1]


KILLED = """
import os, signal
from armodal.tui.command_parts.worker_processes import worker_processes

if __name__ == "__main__":
    with worker_processes(2) as executor:
        assert len(set(executor.map(len, ["a", "bc"]))) == 2
        os.kill(os.getpid(), signal.SIGKILL)
"""


def test_no_process_outlives_one_that_is_killed(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(KILLED)
    # Returns once nobody can write to its output any more, which every process inherits.
    ended = subprocess.run(
        [sys.executable, program],
        env={"PYTHONPATH": str(Path(__file__).parents[3])},
        capture_output=True,
        timeout=100.0,
        check=False,
    )
    assert ended.returncode == -signal.SIGKILL


def test_what_is_run_comes_back_and_no_process_stays():
    before = signal.getsignal(signal.SIGINT)
    others = set(active_children())
    with worker_processes(2) as executor:
        assert list(executor.map(abs, [-1, 2, -3])) == [1, 2, 3]
        assert len(set(active_children()) - others) == 2
        assert signal.getsignal(signal.SIGINT) is before
    assert set(active_children()) == others
