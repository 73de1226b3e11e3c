"""Layers hold, and neither acquisition nor analysis may look at the laboratory's own book."""

import ast
import re
from pathlib import Path

from importlinter.cli import lint_imports

ROOT = Path(__file__).parents[1]
PACKAGES = ("analyzer", "daq", "hil_sim", "protocols", "tui")
SOURCES = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
SECRETS = ("ledger.jsonl", "hil_sim/plants")


# Whether a file has to be parsed at all: the name of a package that is not a part of another.
BARE = re.compile(rf"\b(?:from|import)\b.*(?<![.\w])(?:{'|'.join(PACKAGES)})\b")
SECRET = re.compile("|".join(map(re.escape, SECRETS)))


def nodes_of(path, where):
    """Nodes of a file whose text has a pattern somewhere."""
    text = path.read_text(encoding="utf-8")
    return ast.walk(ast.parse(text)) if where.search(text) else ()


def imported_by(node):
    if isinstance(node, ast.ImportFrom) and not node.level:
        return [node.module]
    return [alias.name for alias in node.names] if isinstance(node, ast.Import) else []


def test_layers_and_devices_are_kept_apart(monkeypatch):
    monkeypatch.chdir(ROOT)
    assert lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True) == 0


def test_sources_import_one_another_only_as_parts_of_armodal():
    """A second copy of a module, found beside `armodal/`, would have classes of its own."""
    strays = [
        (path.relative_to(ROOT), name)
        for path in SOURCES
        for node in nodes_of(path, BARE)
        for name in imported_by(node)
        if name.split(".")[0] in PACKAGES
    ]
    assert strays == []


def test_measuring_sources_name_neither_ledger_nor_plant_file():
    named = [
        (path.relative_to(ROOT), node.value)
        for path in SOURCES
        if path.relative_to(ROOT).parts[0] in {"daq", "analyzer"}
        for node in nodes_of(path, SECRET)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        if any(secret in node.value for secret in SECRETS)
    ]
    assert named == []
