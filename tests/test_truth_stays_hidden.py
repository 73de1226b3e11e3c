"""Neither acquisition nor analysis may look at the laboratory's own book."""

import ast
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LAYERS = [{"tui"}, {"daq", "analyzer", "hil_sim"}, {"protocols"}]
PACKAGES = set().union(*LAYERS)
SOURCES = sorted(p for package in PACKAGES for p in (ROOT / package).rglob("*.py"))
MEASURING = [p for p in SOURCES if p.relative_to(ROOT).parts[0] in {"daq", "analyzer"}]


def name_of(path):
    return str(path.relative_to(ROOT))


def nodes_of(path):
    return ast.walk(ast.parse(path.read_text(encoding="utf-8")))


def imported(path):
    """Our packages that a source imports, wherever in it."""
    modules = set()
    for node in nodes_of(path):
        if isinstance(node, ast.ImportFrom) and not node.level:
            modules.add(node.module)
        if isinstance(node, ast.Import):
            modules.update(name.name for name in node.names)
    return {module.split(".")[0] for module in modules} & PACKAGES


def allowed(package):
    """A package may import itself and those of the layers below its own."""
    own = next(i for i, layer in enumerate(LAYERS) if package in layer)
    return {package}.union(*LAYERS[own + 1 :])


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_source_imports_only_its_own_package_and_layers_below(path):
    assert imported(path) <= allowed(path.relative_to(ROOT).parts[0])


def test_the_layers_are_those_of_the_import_contract():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (layers,) = [c["layers"] for c in contracts if c["type"] == "layers"]
    assert [set(layer.split(" | ")) for layer in layers] == LAYERS


@pytest.mark.parametrize("path", MEASURING, ids=name_of)
def test_source_names_neither_ledger_nor_plant_file(path):
    for node in nodes_of(path):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            assert "ledger.jsonl" not in node.value
            assert "hil_sim/plants" not in node.value
