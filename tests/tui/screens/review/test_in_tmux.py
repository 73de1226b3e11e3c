"""One review in a real terminal, read as an operator reads it."""

import json
import re
import shlex
import shutil
import subprocess
import sys
import time

import pytest
from support.terminal import Terminal as ShellTerminal

from armodal.protocols.session.hdf5 import write_session

pytestmark = pytest.mark.skipif(shutil.which("tmux") is None, reason="needs tmux")

DEADLINE_S = 120.0  # far beyond what a loaded machine needs
DEMO_S = 900.0  # the demo takes two to three minutes on two quiet cores


class Terminal:
    def __init__(self, socket, command, size):
        self._tmux = ["tmux", "-S", str(socket), "-f", "/dev/null"]
        columns, rows = map(str, size)
        subprocess.run(
            [*self._tmux, "new-session", "-d", "-x", columns, "-y", rows, *command], check=True
        )

    def screen(self):
        done = subprocess.run(
            [*self._tmux, "capture-pane", "-p"], capture_output=True, text=True, check=False
        )
        return done.stdout

    def press(self, *keys):
        subprocess.run([*self._tmux, "send-keys", *keys], check=True)

    def wait_for(self, pattern):
        """Poll until the screen shows the pattern: the condition, not the time, ends the wait."""
        end = time.monotonic() + DEADLINE_S
        while time.monotonic() < end:
            found = re.search(pattern, self.screen())
            if found:
                return found
            time.sleep(0.05)
        raise AssertionError(f"never saw {pattern!r}; last screen:\n{self.screen()}")

    def close(self):
        subprocess.run([*self._tmux, "kill-server"], check=False, capture_output=True)


def test_a_session_is_reviewed_in_a_real_terminal(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    command = [sys.executable, "-m", "armodal.tui.cli", "review", str(path)]
    terminal = Terminal(tmp_path / "tmux", command, (160, 45))
    try:
        terminal.wait_for(r"4 modes automatic")
        terminal.press("4")
        terminal.wait_for(r"structural")
        terminal.press("6")
        first = terminal.wait_for(r"mode 1/4: (\d+\.\d+) Hz")
        terminal.press("n")
        second = terminal.wait_for(r"mode 2/4: (\d+\.\d+) Hz")
        assert float(second[1]) > float(first[1])
        terminal.wait_for(r"\d+ pictures/s")
        terminal.press("q")
        end = time.monotonic() + DEADLINE_S
        while "mode 2/4" in terminal.screen() and time.monotonic() < end:
            time.sleep(0.05)
        assert "mode 2/4" not in terminal.screen()
        assert not path.with_suffix(".picked.json").exists()
    finally:
        terminal.close()


@pytest.mark.long
def test_the_proposed_test_runs_in_the_same_terminal(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    proposed = {"words": "Once more.", "plan_toml": session.header.plan.text}
    found = json.dumps({"verdict": "ambiguous", "next_test": proposed})
    path.with_suffix(".gap.json").write_text(found)
    command = [sys.executable, "-m", "armodal.tui.cli", "review", str(path)]
    with ShellTerminal(command, columns=100, rows=30) as terminal:
        terminal.until(r"4 modes automatic", DEADLINE_S)
        terminal.keys("8")
        terminal.until(r"Next test: Once more", DEADLINE_S)
        terminal.keys("n")
        terminal.until(r"measure it now", DEADLINE_S)
        terminal.keys("n")
        terminal.until(r"SIMULATED(.|\n)*Are these sensors mounted", DEADLINE_S)
        terminal.keys("q")
        terminal.until(r"ended 0", DEADLINE_S)


@pytest.mark.long
def test_from_home_to_a_report_by_keys_alone_at_80_by_24(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    home = f"cd {shlex.quote(str(tmp_path))} && exec {shlex.quote(sys.executable)} -m"
    with ShellTerminal(["sh", "-c", f"{home} armodal.tui.cli"], columns=80, rows=24) as terminal:
        terminal.until(r"s\.h5(.|\n)*new session", DEADLINE_S)
        terminal.keys("Enter")
        terminal.until(r"4 modes automatic", DEADLINE_S)
        terminal.keys("w")
        terminal.until(r"report .*s\.html|s\.html", DEADLINE_S)
        terminal.keys("q")
        terminal.until(r"new session", DEADLINE_S)
        terminal.keys("q")
        terminal.until(r"next: armodal report(.|\n)*ended 0", DEADLINE_S)
    assert "What to do next" in path.with_suffix(".html").read_text(encoding="utf-8")


@pytest.mark.long
def test_the_demo_from_home_ends_in_its_review_and_its_report_by_keys_alone_at_80_by_24(tmp_path):
    home = f"cd {shlex.quote(str(tmp_path))} && exec {shlex.quote(sys.executable)} -m"
    with ShellTerminal(["sh", "-c", f"{home} armodal.tui.cli"], columns=80, rows=24) as terminal:
        terminal.until(r"new session", DEADLINE_S)
        terminal.keys("d")
        terminal.until(r"\d+ hits accepted", DEADLINE_S)
        terminal.until(r"test 1 · \d+ modes automatic", DEMO_S)
        terminal.keys("8")
        terminal.until(r"NAMED(.|\n)*k: ", DEADLINE_S)
        terminal.keys("w")
        terminal.until(r"report .*demo\.html|demo\.html", DEADLINE_S)
        terminal.keys("q")
        terminal.until(r"demo\.h5(.|\n)*new session", DEADLINE_S)
        terminal.keys("q")
        terminal.until(r"ended 0", DEADLINE_S)
    (report,) = tmp_path.rglob("demo.html")
    assert "What to do next" in report.read_text(encoding="utf-8")
