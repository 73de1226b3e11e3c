"""What docs/licences.md says of packages and shipped files."""

from __future__ import annotations

import fnmatch
import re
import tomllib
from email.message import Message
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest
from support.pinned import CONSTRAINTS, ROOT, normalized, pinned

PAGE = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")


def rows(heading: str) -> list[list[str]]:
    """Return the rows of the first table under a heading, without its head."""
    section = PAGE.split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


PACKAGES = rows("Packages")


def said(metadata: Message) -> str:
    """Return what a package's metadata says of its licence."""
    expression = metadata.get("License-Expression")
    if expression:
        return str(expression)
    classifiers = metadata.get_all("Classifier", [])
    named = [line.split(" :: ")[-1] for line in classifiers if line.startswith("License ::")]
    first = next(iter((metadata.get("License") or "").strip().splitlines()), "")
    return ", ".join(named) or first.strip() or "nothing"


def test_the_table_names_every_pinned_package_once():
    named = [normalized(package) for package, *_ in PACKAGES]
    assert sorted(named) == sorted(pinned(CONSTRAINTS))


@pytest.mark.parametrize(("package", "metadata"), [(row[0], row[2]) for row in PACKAGES])
def test_installed_metadata_is_what_the_table_says(package, metadata):
    try:
        installed = distribution(package)
    except PackageNotFoundError:
        pytest.skip("not installed")
    version, _ = pinned(CONSTRAINTS)[normalized(package)]
    if installed.version != version.partition(";")[0]:
        pytest.skip("another version is installed")
    assert said(installed.metadata) == metadata


def test_every_licence_has_a_reason():
    reasons = {
        name.strip() for row in rows("Why each licence allows this") for name in row[0].split(",")
    }
    for package, _, _, licence in PACKAGES:
        assert set(re.split(r" (?:OR|AND) ", licence)) <= reasons, package


def test_what_runs_is_under_no_copyleft_but_python_can():
    running = {row[0]: row[3] for row in PACKAGES if row[1].startswith("run")}
    assert [name for name, licence in running.items() if "GPL" in licence or "MPL" in licence] == [
        "python-can"
    ]


def says_its_own(path: Path) -> bool:
    """Return whether a file, or the arm file that names this URDF, begins with its licence."""
    texts = [path.read_text(encoding="utf-8")]
    if path.suffix == ".urdf":
        others = [other.read_text(encoding="utf-8") for other in path.parent.glob("*.toml")]
        texts = [text for text in others if f'urdf = "{path.name}"' in text]
    return any(text.startswith("# Licence: ") for text in texts)


def test_every_shipped_robot_file_has_an_origin():
    patterns = []
    for named, *_ in rows("Robot files"):
        folder = ""
        for path in re.findall(r"`([^`]+)`", named):  # a second file lies beside the first
            folder = path.rpartition("/")[0] or folder
            patterns.append(f"{folder}/{path.rpartition('/')[2]}")
    shipped = [
        path.relative_to(ROOT).as_posix()
        for folder in ("protocols", "hil_sim")
        for suffix in ("toml", "urdf", "dbc")
        for path in (ROOT / folder).rglob(f"*.{suffix}")
    ]
    assert shipped
    missing = [path for path in shipped if not any(fnmatch.fnmatch(path, p) for p in patterns)]
    assert [path for path in missing if not says_its_own(ROOT / path)] == []


def test_the_package_states_its_licence_and_carries_its_text():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["license"] == "BSD-3-Clause"
    assert said(distribution("armodal").metadata) == "BSD-3-Clause"
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert text.startswith("BSD 3-Clause License")
    assert "The armodal authors" in text
