"""One review in a real terminal, read as an operator reads it."""

import json
import re
import shlex
import shutil
import sys

import pytest
from support.terminal import Terminal, armodal

from armodal.protocols.session.hdf5 import write_session

pytestmark = pytest.mark.skipif(shutil.which("tmux") is None, reason="needs tmux")

DEMO_S = 225.0  # the demo takes two to three minutes on two quiet cores


@pytest.mark.long
def test_a_session_is_reviewed_in_a_real_terminal(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    with Terminal(armodal("review", str(path)), columns=160, rows=45) as terminal:
        terminal.until(r"4 modes automatic")
        terminal.keys("4")
        terminal.until(r"structural")
        terminal.keys("6")
        first = frequency_hz(terminal, 1)
        terminal.keys("n")
        assert frequency_hz(terminal, 2) > first
        terminal.until(r"\d+ pictures/s")
        terminal.keys("q")
        assert "mode 2/4" not in terminal.until(r"ended 0")
    assert not path.with_suffix(".picked.json").exists()


def frequency_hz(terminal, mode):
    shown = rf"mode {mode}/4: (\d+\.\d+) Hz"
    return float(re.search(shown, terminal.until(shown))[1])


@pytest.mark.long
def test_the_proposed_test_runs_in_the_same_terminal(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    proposed = {"words": "Once more.", "plan_toml": session.header.plan.text}
    found = json.dumps({"verdict": "ambiguous", "next_test": proposed})
    path.with_suffix(".gap.json").write_text(found)
    with Terminal(armodal("review", str(path)), columns=100, rows=30) as terminal:
        terminal.until(r"4 modes automatic")
        terminal.keys("8")
        terminal.until(r"Next test: Once more")
        terminal.keys("n")
        terminal.until(r"measure it now")
        terminal.keys("n")
        terminal.until(r"SIMULATED(.|\n)*Are these sensors mounted")
        terminal.keys("q")
        terminal.until(r"ended 0")


@pytest.mark.long
def test_from_home_to_a_report_by_keys_alone_at_80_by_24(session, tmp_path):
    path = tmp_path / "s.h5"
    write_session(session, path)
    home = f"cd {shlex.quote(str(tmp_path))} && exec {shlex.quote(sys.executable)} -m"
    with Terminal(["sh", "-c", f"{home} armodal.tui.cli"], columns=80, rows=24) as terminal:
        terminal.until(r"s\.h5(.|\n)*new session")
        terminal.keys("Enter")
        terminal.until(r"4 modes automatic")
        terminal.keys("w")
        terminal.until(r"report .*s\.html|s\.html")
        terminal.keys("q")
        terminal.until(r"new session")
        terminal.keys("q")
        terminal.until(r"next: armodal report(.|\n)*ended 0")
    assert "What to do next" in path.with_suffix(".html").read_text(encoding="utf-8")


@pytest.mark.long
def test_the_demo_from_home_ends_in_its_review_and_its_report_by_keys_alone_at_80_by_24(tmp_path):
    home = f"cd {shlex.quote(str(tmp_path))} && exec {shlex.quote(sys.executable)} -m"
    with Terminal(["sh", "-c", f"{home} armodal.tui.cli"], columns=80, rows=24) as terminal:
        terminal.until(r"new session")
        terminal.keys("d")
        terminal.until(r"\d+ hits accepted")
        terminal.until(r"test 1 · \d+ modes automatic", DEMO_S)
        terminal.keys("8")
        terminal.until(r"NAMED(.|\n)*k: ")
        terminal.keys("w")
        terminal.until(r"report .*demo\.html|demo\.html")
        terminal.keys("q")
        terminal.until(r"demo\.h5(.|\n)*new session")
        terminal.keys("q")
        terminal.until(r"ended 0")
    (report,) = tmp_path.rglob("demo.html")
    assert "What to do next" in report.read_text(encoding="utf-8")
