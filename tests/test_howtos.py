"""Whole files of the how-to guides, laid into a copy of the project, do what the guides say."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.howto import PAGES, changed, changes_shown, files_shown

PROJECT = Path(__file__).parents[1]
FOLDERS = ("analyzer", "armodal", "daq", "docs", "hil_sim", "protocols", "tests", "tui")
PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not long")
VECTORS = "tests/vectors/make_board_vectors.py"
LONGEST = 60  # lines of a file, for somebody who adds his first
# What is found in the folders that are searched.
FOUND = {
    "add-a-command": "from armodal.tui.cli import command_modules; print(*command_modules())",
    "add-a-screen": """
from armodal.tui.screens.home.choice import home_choices
from armodal.tui.screens.review.pane import review_panes
from armodal.tui.screens.run.operator_screen import operator_screens
print(*review_panes(), *operator_screens(), *home_choices())""",
    "add-an-arm": """
from armodal.protocols.arm.files import shipped_arms
from armodal.protocols.plan import shipped_plans
print(*shipped_arms(), *shipped_plans())""",
    "add-a-file-format": """
from armodal.protocols.foreign.file_format import every_format
print(*(own.name.lower() for own in every_format()))""",
    "add-a-source-of-samples": """
from pkgutil import iter_modules
from armodal.daq.front_end import drivers
print(*(module.name for module in iter_modules(drivers.__path__)))""",
    "add-a-source-of-joint-angles": """
from armodal.daq.controller import controller_options
print(*controller_options())""",
    "add-an-effect": """
from armodal.analyzer.gap.library import hooks
from armodal.hil_sim.effects import modules_with
print(*(make.__module__.split(".")[-1] for make in hooks("instances")))
print(*modules_with("__all__"))""",
}
# Tests of all that is found, beside those that the guide shows.
OF_ALL = {
    "add-a-command": ("tests/tui/test_cli.py", "tests/tui/test_start.py"),
    "add-a-screen": (
        "tests/tui/screens/review/test_pane.py",
        "tests/tui/screens/run/test_operator_screen.py",
        "tests/tui/screens/home/test_choice.py",
    ),
    "add-an-arm": (
        "tests/protocols/test_plan.py",
        "tests/hil_sim/test_rehearsal.py",
        "tests/test_licences.py::test_every_shipped_robot_file_has_an_origin",
    ),
    "add-a-file-format": (
        "tests/protocols/foreign/test_file_format.py",
        "tests/protocols/foreign/test_any_bytes.py",
    ),
    "add-a-source-of-samples": ("tests/protocols/test_front_end.py",),
    "add-a-source-of-joint-angles": ("tests/tui/test_bad_input.py",),
    "add-a-message": (
        "tests/protocols/test_board_table.py",
        "tests/protocols/test_board_vectors.py",
        "tests/protocols/c/test_device.py",
        "tests/protocols/c/test_payloads.py",
        "tests/daq/test_check_board.py::test_every_step_passes_on_a_healthy_board",
    ),
    "add-an-effect": (
        "tests/analyzer/gap/test_every_effect.py",
        "tests/analyzer/gap/test_effects_own_themselves.py",
        "tests/analyzer/gap/test_no_shared_numbers.py",
        "tests/analyzer/gap/test_priors_have_sources.py",
        "tests/test_truth_stays_hidden.py",
        "tests/hil_sim/test_study.py",
        "tests/hil_sim/test_of_file.py",
    ),
}
SHOWN = {page.stem: files_shown(page.stem) for page in sorted(PAGES.glob("add-*.md"))}


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the project that may be added to."""
    root = tmp_path_factory.mktemp("project")
    left_out = shutil.ignore_patterns("__pycache__")
    for name in FOLDERS:
        shutil.copytree(PROJECT / name, root / name, symlinks=True, ignore=left_out)
    shutil.copy(PROJECT / "pyproject.toml", root)
    return root


def run_in(root: Path, *command: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(root)}
    return subprocess.run(
        [sys.executable, *command],
        cwd=root,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.long
@pytest.mark.parametrize("page", FOUND)
def test_what_a_guide_shows_is_found_by_itself_and_its_tests_pass(copy, page):
    files = SHOWN[page]
    for name, text in files.items():
        assert not (copy / name).exists()
        assert len(text.splitlines()) <= LONGEST
        (copy / name).write_text(text, encoding="utf-8")
    try:
        tests = [name for name in files if name.startswith("tests/")]
        found = run_in(copy, "-c", FOUND[page]).stdout.split()
        assert {Path(name).stem for name in files.keys() - set(tests)} <= set(found)
        ran = run_in(copy, *PYTEST, *tests, *OF_ALL[page])
        assert ran.returncode == 0, ran.stdout
        for tool in (("format", "--check"), ("check",)):
            ran = run_in(copy, "-m", "ruff", *tool, *(name for name in files if name[-3:] == ".py"))
            assert ran.returncode == 0, ran.stdout
    finally:
        for name in files:
            (copy / name).unlink()


@pytest.mark.long
def test_the_message_that_the_guide_shows_works_on_both_sides(copy):
    page, files = "add-a-message", SHOWN["add-a-message"]
    before = {}
    for name, change in changes_shown(page).items():
        before[name] = (copy / name).read_text(encoding="utf-8")
        (copy / name).write_text(changed(before[name], change), encoding="utf-8")
        assert sum(line[0] == "+" for line in change.splitlines()) <= LONGEST
    assert len(before) <= 2
    assert len(files) <= 2
    for name, text in files.items():
        (copy / name).write_text(text, encoding="utf-8")
    try:
        for made in (("-m", "armodal.protocols.board.generate"), (VECTORS,)):
            ran = run_in(copy, *made)
            assert ran.returncode == 0, ran.stderr
        ran = run_in(copy, *PYTEST, *files, *OF_ALL[page])
        assert ran.returncode == 0, ran.stdout
        python = [name for name in (*files, *before) if name.endswith(".py")]
        for tool in (("format", "--check"), ("check",)):
            ran = run_in(copy, "-m", "ruff", *tool, *python)
            assert ran.returncode == 0, ran.stdout
    finally:
        for name in files:
            (copy / name).unlink()
        for name, text in before.items():
            (copy / name).write_text(text, encoding="utf-8")
        for made in (("-m", "armodal.protocols.board.generate"), (VECTORS,)):
            run_in(copy, *made)
