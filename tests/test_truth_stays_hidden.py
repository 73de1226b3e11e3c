"""Neither acquisition nor analysis may look at the laboratory's own book."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = sorted(p for package in ("daq", "analyzer") for p in (ROOT / package).rglob("*.py"))


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_source_names_neither_ledger_nor_plant_file(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            assert not (node.module or "").startswith("hil_sim")
        if isinstance(node, ast.Import):
            assert not any(name.name.startswith("hil_sim") for name in node.names)
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            assert "ledger.jsonl" not in node.value
            assert "hil_sim/plants" not in node.value
